"""Recordings of people in every format, and the scenarios made from them."""

import gzip
import sqlite3
import time

import numpy as np
import pandas as pd
import pedpy
import pytest
import shapely

from benchnav import import_recording
from benchnav.arena.body import absent
from benchnav.cli.main import status
from benchnav.errors import BenchnavError, MapError, ScenarioError, UsageError
from benchnav.generation.build import build
from benchnav.generation.recorded_people import read_people
from benchnav.scenario.load import load_scenario
from tests.importers.data import published

# two people, ten frames a second: one walks east at 1 m/s, one north at 0.5 m/s from frame 5 on
FRAMES = {1: range(41), 2: range(5, 51)}


def rows():
    for n, frames in FRAMES.items():
        for f in frames:
            yield f, n, *((0.1 * f, 2.0) if n == 1 else (1.0, 0.05 * (f - 5)))


def written(path, lines):
    path.write_text("\n".join(lines) + "\n")
    return path


def eth(folder):
    return written(
        folder / "obsmat.txt", [f" {f}e0 {n} {x} 0.0 {y} 1 0 1" for f, n, x, y in rows()]
    )


def text(folder):
    return written(folder / "plain.txt", [f"{f} {n} {x} {y}" for f, n, x, y in rows()])


def trajnetpp(folder):
    lines = [f'{{"track": {{"f": {f}, "p": {n}, "x": {x}, "y": {y}}}}}' for f, n, x, y in rows()]
    return written(folder / "t.ndjson", ['{"scene": {"id": 0, "p": 1, "s": 0, "e": 50}}', *lines])


def juelich(folder):
    head = ["# framerate: 10 fps", "# id frame x/cm y/cm z/cm"]
    lines = [f"{n} {f} {100 * x} {100 * y} 170" for f, n, x, y in rows()]
    return written(folder / "j.txt", [*head, *lines])


def hdf5(folder):
    h5py = pytest.importorskip("h5py")
    kinds = [("id", "i8"), ("frame", "i8"), ("x", "f8"), ("y", "f8")]
    table = np.array([(n, f, x, y) for f, n, x, y in rows()], kinds)
    with h5py.File(folder / "r.h5", "w") as file:
        file.create_dataset("trajectory", data=table).attrs["fps"] = 10.0
        file.attrs["wkt_geometry"] = shapely.box(-3, -3, 9, 9).wkt
    return folder / "r.h5"


def jupedsim(folder):
    with sqlite3.connect(folder / "j.sqlite") as file:
        file.execute("create table trajectory_data (frame int, id int, pos_x real, pos_y real)")
        file.executemany("insert into trajectory_data values (?, ?, ?, ?)", list(rows()))
        file.execute("create table metadata (key text, value text)")
        file.execute("insert into metadata values ('fps', '10'), ('version', '1')")
        file.execute("create table geometry (wkt text)")
        file.execute("insert into geometry values (?)", (shapely.box(-3, -3, 9, 9).wkt,))
    return folder / "j.sqlite"


def vadere(folder):
    head = "pedestrianId simTime endTime-PID1 startX-PID1 startY-PID1 endX-PID1 endY-PID1"
    lines = []
    for n, frames in FRAMES.items():
        ways = {f: (x, y) for f, m, x, y in rows() if m == n}
        for f in list(frames)[:-1]:
            (a, b), (c, d) = ways[f], ways[f + 1]
            lines.append(f"{n} {0.1 * f} {0.1 * (f + 1)} {a} {b} {c} {d}")
    return written(folder / "v.traj", [head, *lines])


def viswalk(folder):
    head = ["$VISION", "* a comment", "$PEDESTRIAN:NO;SIMSEC;COORDCENTX;COORDCENTY"]
    lines = [f"{n};{0.1 * f:.1f};{x};{y}" for f, n, x, y in rows()]
    return written(folder / "v.pp", [*head, *lines])


def crowdit(folder):
    lines = ["pedID,time,posX,posY", *(f"{n},{0.1 * f:.1f},{x},{y}" for f, n, x, y in rows())]
    path = folder / "c.csv.gz"
    path.write_bytes(gzip.compress("\n".join(lines).encode()))
    return path


def pathfinder(folder):
    lines = ['"t","id","name","x","y","z"', '"s","","","m","m","m"']
    lines += [f'{0.1 * f:.1f},{n},"{n:05}",{x},{y},0' for f, n, x, y in rows()]
    return written(folder / "p.csv", lines)


WRITERS = {
    "eth": (eth, {"rate": 10}), "text": (text, {"rate": 10}),
    "trajnetpp": (trajnetpp, {"rate": 10}), "juelich": (juelich, {}), "hdf5": (hdf5, {}),
    "jupedsim": (jupedsim, {}), "vadere": (vadere, {"rate": 10}), "viswalk": (viswalk, {}),
    "crowdit": (crowdit, {}), "pathfinder-csv": (pathfinder, {}),
}  # fmt: skip


def imported(path, folder, **options):
    return load_scenario(
        import_recording(path, folder / "out" / "s.yaml", quiet=True, **options)[0]
    )


@pytest.mark.parametrize("given", [True, False])
@pytest.mark.parametrize("format", WRITERS)
def test_every_format_gives_the_same_people(tmp_path, format, given):
    write, options = WRITERS[format]
    if given:
        options = {**options, "format": format}
    scenario = imported(write(tmp_path), tmp_path, **options)
    assert scenario.name.startswith("people/")
    first, second = read_people(scenario)
    assert (first.number, second.number) == (1, 2)
    late = 1e-6 if format != "vadere" else 0.11  # events: frames begin within the first step
    np.testing.assert_allclose(second.time[[0, -1]], [0.5, 5.0], atol=late)
    np.testing.assert_allclose(first.place[[0, -1]], [[0, 2], [4, 2]], atol=late)
    np.testing.assert_allclose(second.place[[0, -1]], [[1, 0], [1, 2.25]], atol=late)
    assert bool(scenario.walls) == (format in ("hdf5", "jupedsim"))
    world = build(scenario, "test", 0)
    assert len(world.bodies) == 1


@pytest.mark.parametrize(
    ("head", "row", "columns"),
    [
        (["frame,id,x,y"], "{f},{n},{x},{y}", None),
        (["id;frame;x [m];y [m];z"], "{n};{f};{x};{y};1", None),
        (["# a comment", "# PersID\tFrame\tX\tY\tZ"], "{n}\t{f}\t{x}\t{y}\t1.7", None),
        ([], "{n} {f} 0 {x} {y}", ["id", "frame", "_", "x", "y"]),
        (["% made by hand", ""], "  {f}   {n}  {x}  {y}", None),
        (["\ufeffframe\tid\tx\ty"], "{f}\t{n}\t{x}\t{y}", None),
    ],
)
def test_columns_headers_and_comments(tmp_path, head, row, columns):
    lines = [row.format(f=f, n=n, x=x, y=y) for f, n, x, y in rows()]
    path = written(tmp_path / "t.csv", [*head, *lines])
    first, _ = read_people(imported(path, tmp_path, rate=10, columns=columns, format="text"))
    np.testing.assert_allclose(first.place[[0, -1]], [[0, 2], [4, 2]])


def test_rows_without_a_place_are_missing_values(tmp_path):
    lines = [f"{f} {n} {x} {y}" for f, n, x, y in rows()]
    lines[3], lines[10] = "3 1 nan nan", "10 1 ? ?"
    first, _ = read_people(imported(written(tmp_path / "t.txt", lines), tmp_path, rate=10))
    assert len(first.time) == 39


def test_gaps_are_refused_split_or_bridged(tmp_path):
    lines = [f"{f} {n} {x} {y}" for f, n, x, y in rows() if not (n == 1 and 10 < f < 30)]
    path = written(tmp_path / "t.txt", lines)
    with pytest.raises(ScenarioError, match=r"t\.txt:12: .* id 1 has a gap of 2 s, between the"):
        imported(path, tmp_path, rate=10)
    bridged = read_people(imported(path, tmp_path, rate=10, gaps="bridge", force=True))
    assert [track.number for track in bridged] == [1, 2]
    parts = read_people(imported(path, tmp_path, rate=10, gaps="split", force=True))
    assert [(t.number, t.time[0], t.time[-1]) for t in parts] == [
        (1, 0.0, 1.0), (2, 0.5, 5.0), (3, 3.0, 4.0)
    ]  # fmt: skip


def test_units_scale_and_a_wrong_unit_is_noticed(tmp_path):
    path = written(tmp_path / "t.txt", [f"{f} {n} {1e3 * x} {1e3 * y}" for f, n, x, y in rows()])
    first, _ = read_people(imported(path, tmp_path, rate=10, unit="mm"))
    np.testing.assert_allclose(first.place[-1], [4, 2])
    with pytest.raises(ScenarioError, match=r"people would walk at .* m/s .*Set the option 'unit'"):
        imported(path, tmp_path, rate=10, force=True)


def test_the_robot_replaces_the_chosen_person_or_none(tmp_path):
    world = build(imported(text(tmp_path), tmp_path, rate=10, replace=2), "test", 0)
    np.testing.assert_allclose(world.agents.start, [[1, 0]])
    empty = imported(text(tmp_path), tmp_path, rate=10, replace="none", force=True)
    world = build(empty, "test", 0)
    assert len(world.bodies) == 2
    assert (len(world.agents), world.teams) == (1, ("robot",))


def test_walls_are_a_hull_wkt_or_an_image(tmp_path):
    from PIL import Image

    def walls(**options):
        made = imported(text(tmp_path), tmp_path, rate=10, force=True, **options)
        build(made, "test", 0)
        return made.walls

    assert len(walls(walls="hull")) >= 3
    area = shapely.box(-3, -3, 9, 9).difference(shapely.box(5, 5, 6, 6))
    (tmp_path / "area.wkt").write_text(area.wkt)
    assert sorted(w.shape.type for w in walls(walls=tmp_path / "area.wkt")) == [
        "polygon", *["polyline"] * 4
    ]  # fmt: skip
    Image.fromarray(np.full((40, 40), 255, np.uint8)).save(tmp_path / "map.png")
    place = {"wall_cell": 0.5, "wall_origin": (-5, -5)}
    (wall,) = walls(walls=tmp_path / "map.png", **place)
    assert wall.shape.type == "occupancy"
    Image.fromarray(np.zeros((40, 40), np.uint8)).save(tmp_path / "dark.png")
    assert walls(walls=tmp_path / "dark.png", **place, wall_negate=True)
    with pytest.raises(BenchnavError):  # everybody stands in walls
        walls(walls=tmp_path / "dark.png", **place)
    with pytest.raises(UsageError, match="'wall-cell', its metres per pixel"):
        walls(walls=tmp_path / "map.png")
    (tmp_path / "bad.wkt").write_text("POLYGON ((0 0, 1")
    with pytest.raises(MapError, match=r"bad\.wkt:1: must be the walkable area as WKT"):
        walls(walls=tmp_path / "bad.wkt")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, r"The rate must be given: how many frames a second"),
        ({"rate": 0}, "The rate must be > 0"),
        ({"rate": 10, "unit": "mile"}, "The unit must be m, cm, mm, ft, in, or a number"),
        ({"rate": 10, "format": "ethh"}, r"Got 'ethh' instead. Did you mean 'eth'"),
        ({"rate": 10, "replace": 7}, r"Got '7'; .*plain\.txt has 1, 2\."),
        ({"rate": 10, "columns": ["frame", "id", "x"]}, "columns must name frame, id, x and y"),
        ({"rate": 10, "gaps": "no"}, "gaps must be refuse, split or bridge"),
        ({"rate": 10, "name": "A b"}, "must consist of small letters"),
        ({"rate": 10, "horizon": -1}, "horizon must be > 0"),
        ({"rate": 10, "format": "vadere"}, r"plain\.txt:1: must be a trajectory file of Vadere"),
        ({"format": "juelich", "unit": "m"}, "has no frame rate; set the option 'rate'"),
        ({"format": "juelich", "rate": 10}, "does not say its unit; set the option 'unit'"),
    ],
)
def test_mistakes_of_the_call(tmp_path, options, message):
    with pytest.raises(BenchnavError, match=message):
        imported(text(tmp_path), tmp_path, **options)


def test_the_command(tmp_path, capsys):
    path = text(tmp_path)
    out = tmp_path / "few.yaml"
    code = status(["import", "recording", str(path), "--out", str(out), "--rate", "10"])
    shown = capsys.readouterr()
    assert code == 0
    assert shown.out.split() == [str(out), str(tmp_path / "few-people.csv")]
    assert "87 rows, 2 people, 5.0 s at 10 frames a second" in shown.err
    assert status(["import", "recording", str(path), "--out", str(out), "--rate", "10"]) == 2


PUBLISHED = {
    "people/eth/obsmat.txt": {"rate": 15},
    "people/pedpy/040_c_56_h-.txt": {},
    "people/pedpy/traj_UNI_CORR_500_01.txt": {"unit": "m"},
    "people/pedpy/trajectories.sqlite": {},
}


def original(path):
    """The recording as PedPy has it."""
    if path.name == "obsmat.txt":
        table = np.loadtxt(path)[:, [1, 0, 2, 4]]
        data = pd.DataFrame(table, columns=["id", "frame", "x", "y"])
        return pedpy.TrajectoryData(data.astype({"id": int, "frame": int}), frame_rate=15.0)
    if path.suffix == ".sqlite":
        return pedpy.load_trajectory_from_jupedsim_sqlite(trajectory_file=path)
    unit = pedpy.TrajectoryUnit.METER
    return pedpy.load_trajectory(trajectory_file=path, default_unit=unit)


def walked(world, like):
    """The people of a world at the frames of a recording, as PedPy reads them."""
    first, rate = like.data.frame.min(), like.frame_rate
    frames = np.unique(like.data.frame)
    times = (frames - first) * (1.0 / rate)
    parts = []
    for n, law in enumerate(body.law for body in world.bodies):
        place = np.stack([np.interp(times, law.times, law.points[:, k]) for k in (0, 1)], axis=1)
        here = ~absent(place)
        parts.append(
            pd.DataFrame({"id": n, "frame": frames[here], "x": place[here, 0], "y": place[here, 1]})
        )
    return pedpy.TrajectoryData(pd.concat(parts, ignore_index=True), frame_rate=rate)


@pytest.mark.parametrize("name", PUBLISHED)
def test_speed_and_density_are_pedpys(tmp_path, name):
    path = published(name)
    scenario = imported(path, tmp_path, replace="none", horizon=500, **PUBLISHED[name])
    expected = original(path)
    found = walked(build(scenario, "test", 0), expected)
    lone = expected.data.groupby("id").filter(lambda track: len(track) < 2)
    assert len(found.data) == len(expected.data) - len(lone)
    step = 6 if path.name == "obsmat.txt" else 5
    speeds = [
        pedpy.compute_individual_speed(
            traj_data=data, frame_step=step,
            speed_calculation=pedpy.SpeedCalculation.BORDER_EXCLUDE,
        ).speed
        for data in (found, expected)
    ]  # fmt: skip
    assert speeds[0].mean() == pytest.approx(speeds[1].mean(), rel=1e-9)
    low = expected.data[["x", "y"]].quantile(0.25)
    high = expected.data[["x", "y"]].quantile(0.75)
    area = pedpy.MeasurementArea(shapely.box(low.x, low.y, high.x, high.y))
    densities = [
        pedpy.compute_classic_density(traj_data=data, measurement_area=area).density.to_numpy()
        for data in (found, expected)
    ]
    np.testing.assert_allclose(densities[0].mean(), densities[1].mean(), rtol=1e-9)


def test_a_large_recording_takes_little_processor_time(tmp_path):
    """100,000 rows take 0.6 s; the bound only catches a loop that is quadratic."""
    path = tmp_path / "large.txt"
    frames = np.repeat(np.arange(500), 200)
    number = np.tile(np.arange(200), 500)
    place = np.column_stack([0.04 * frames, 0.5 * number])
    np.savetxt(path, np.column_stack([frames, number, place]), fmt="%d %d %.4f %.4f")
    began = time.process_time()
    imported(path, tmp_path, rate=25)
    assert time.process_time() - began < 30.0
