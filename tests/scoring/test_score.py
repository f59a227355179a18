"""Scores of tables: known values, reasons for what is unknown, and round trips of a run."""

import math

import numpy as np
import pandas as pd
import pedpy
import pytest
import shapely
import yaml

import benchnav
from benchnav.errors import TrajectoryError, UsageError
from benchnav.scenario.importers.recording.formats import FORMATS
from benchnav.scoring.bodies import SHAPE
from tests.importers.data import published

SCENARIO = {
    "name": "two/ways", "version": 1, "title": "Two ways", "bounds": [-6, -6, 6, 6],
    "walls": [{"shape": {"type": "box", "width": 1, "depth": 1}}],
    "teams": [
        {
            "name": "crowd", "count": 6, "radius": 0.3, "max_speed": 1.2,
            "start": {"type": "circle", "radius": 5, "jitter": 0.3}, "goal": {"type": "antipodal"},
        }
    ],
    "clock": {"dt": 0.2, "horizon": 30}, "rules": {"on_arrival": "vanish"},
    "measurement_area": [-2, -2, 2, 2],
}  # fmt: skip


def rows(*tracks, dt=0.1):
    """A table of (id, first time, start, velocity, number of rows)."""
    found = [
        (begin + k * dt, name, x + u * k * dt, y + v * k * dt)
        for name, begin, (x, y), (u, v), count in tracks
        for k in range(count)
    ]
    return pd.DataFrame(found, columns=["time", "id", "x", "y"])


def scored(table, tmp_path, **options):
    path = tmp_path / "table.csv"
    table.to_csv(path, index=False)
    found = benchnav.score(path, quiet=True, **options)
    return {record.metric: record for record in found.records}


def test_two_that_pass_each_other(tmp_path):
    table = rows(("a", 0, (0, 0), (1, 0), 101), ("b", 0, (10, 0.5), (-1, 0), 101))
    found = scored(table, tmp_path, radius=0.2, goals="last", preferred_speed=1.0)
    assert found["path_length"].value == pytest.approx(10)
    assert found["time_to_goal"].value == pytest.approx(10, abs=1e-5)
    assert found["min_clearance"].value == pytest.approx(0.1)
    assert found["collided"].value == 0
    assert found["spl"].value == found["success"].value == found["arrival"].value == 1
    wider = scored(table, tmp_path, radius=0.3, goals="last")
    assert wider["collided"].value == wider["collisions_agent"].value == 1
    assert wider["min_clearance"].value == pytest.approx(-0.1)
    half = math.sqrt(0.6**2 - 0.5**2) + math.sqrt(0.61**2 - 0.5**2)
    assert wider["contact_time"].value == pytest.approx(half / 2, abs=1e-4)
    assert wider["success"].value == 0


def test_those_who_are_not_there_at_the_same_time_do_not_meet(tmp_path):
    first, later = ("a", 0, (0, 0), (1, 0), 41), ("b", 5, (0, 0), (1, 0), 41)
    found = scored(rows(first, later), tmp_path, radius=0.3, goals="last")
    assert found["collided"].value == 0
    assert math.isnan(found["min_clearance"].value)
    assert found["time_to_goal"].value == pytest.approx(4, abs=1e-5)  # each from its own start
    assert found["makespan"].value == pytest.approx(9, abs=1e-5)  # at the times of the table
    crossing = rows(first, ("b", 1, (2, -1), (0, 1), 31))  # both at (2, 0) after 2 s
    assert scored(crossing, tmp_path, radius=0.1)["collided"].value == 1


def test_what_a_table_does_not_hold_is_not_applicable_with_the_reason(tmp_path, capsys):
    table = rows(("a", 0, (0, 0), (1, 0), 11))
    found = scored(table, tmp_path)
    assert found["path_length"].value == pytest.approx(1)
    for name, need in {
        "success": "goals, radius", "collisions_wall": "walls, radius",
        "sct": "goals, radius, preferred speed", "timeout": "goals, horizon",
        "latency_p50": "times of decisions", "density_mean": "measurement area",
    }.items():  # fmt: skip
        assert math.isnan(found[name].value)
        assert found[name].fault == f"n/a: needs {need}"
    text = benchnav.score(tmp_path / "table.csv").text("markdown")
    assert "n/a (needs goals)" in text
    assert "needs goals, radius" in text.split("[1]")[-1] or "[1] needs" in text
    assert "- goals: columns goal_x and goal_y, the option 'goals' (last), or a scenario" in (
        capsys.readouterr().err
    )


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    path = folder / "two.yaml"
    path.write_text(yaml.safe_dump(SCENARIO))
    return path, benchnav.run(
        str(path), navigators=["orca", "straight-line"], seeds=2, out=folder / "run", workers=0,
        tracks=["known"], salt="5a", quiet=True,
    )  # fmt: skip


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_an_exported_run_has_the_scores_of_the_run(run, tmp_path, suffix):
    scenario, made = run
    (file,) = made.export(tmp_path / f"run.{suffix}")
    found = {
        (r.navigator, r.metric): r
        for r in benchnav.score(file, scenario=scenario, quiet=True).records
    }
    compared = set()
    for record in made.leaderboard(metrics="all").records:
        ours = found[record.navigator, record.metric]
        if ours.fault:
            continue
        compared.add(record.metric)
        # contacts begin and end at substeps, and motion between rows is straight
        rel = 0.1 if record.metric.startswith(("contact", "collisions")) else 2e-3
        assert ours.value == pytest.approx(record.value, rel=rel, abs=2e-3, nan_ok=True), record
    assert {
        "success",
        "spl",
        "turning",
        "sparc",
        "density_mean",
        "flow",
        "jam",
        "stuck",
    } <= compared


def test_pedpy_reads_what_is_exported(run, tmp_path):
    _, made = run
    files = made.export(tmp_path / "pedpy", to="pedpy", navigator="orca")
    assert [file.suffix for file in files] == [".txt", ".wkt"] * 2
    text, wkt = files[:2]
    loaded = pedpy.load_trajectory(trajectory_file=text)
    episode = made.episodes("orca", seed=0)[0]
    direct = episode.to_pedpy()
    assert loaded.frame_rate == direct.frame_rate == 5
    columns = ["id", "frame", "x", "y"]
    pd.testing.assert_frame_equal(loaded.data[columns], direct.data[columns])
    area = pedpy.WalkableArea(wkt.read_text())
    assert area.polygon.equals(episode.walkable_area())
    assert pedpy.is_trajectory_valid(traj_data=loaded, walkable_area=area)
    speed = pedpy.compute_individual_speed(
        traj_data=loaded, frame_step=1, speed_calculation=pedpy.SpeedCalculation.BORDER_SINGLE_SIDED
    )
    frame = episode.to_pandas()
    ours = np.hypot(frame.vx, frame.vy)[frame.status == "active"].mean()
    assert speed.speed.mean() == pytest.approx(ours, rel=0.05)
    assert (tmp_path / "pedpy").exists()
    score = benchnav.score(text, quiet=True, label="orca")
    lengths = {r.metric: r.value for r in score.records}
    assert lengths["path_length"] == pytest.approx(episode.metric("path_length"), rel=1e-9)


def test_a_gap_is_refused_bridged_or_split(tmp_path):
    table = rows(("a", 0, (0, 0), (1, 0), 41), ("b", 0, (0, 5), (1, 0), 41))
    table = table[~((table.id == "a") & (table.time > 1.05) & (table.time < 1.95))]
    with pytest.raises(
        TrajectoryError,
        match=r"table\.csv:13: a track must have no gap; id a is missing from 1 s to 2 s\.",
    ):
        scored(table, tmp_path)
    assert scored(table, tmp_path, gaps="bridge")["path_length"].value == pytest.approx(4)
    parts = scored(table, tmp_path, gaps="split")["path_length"].value
    assert parts == pytest.approx((1 + 2 + 4) / 3)


def test_densities_are_pedpys_for_those_who_come_and_go(tmp_path):
    rng = np.random.default_rng(3)
    tracks = [
        (n, float(rng.integers(0, 5)), rng.uniform(-3, 3, 2), rng.normal(0, 0.5, 2), 51)
        for n in range(20)
    ]
    table, area = rows(*tracks), (-1.0, -1.0, 1.0, 1.0)
    found = scored(table, tmp_path, area=area)["density_mean"].value
    table["frame"] = (table.time * 10).round().astype(int)
    data = pedpy.TrajectoryData(data=table[["id", "frame", "x", "y"]], frame_rate=10.0)
    cells = pedpy.compute_individual_voronoi_polygons(
        traj_data=data, walkable_area=pedpy.WalkableArea(shapely.box(-20, -20, 20, 20)),
        cut_off=pedpy.Cutoff(radius=0.8, quad_segments=16),
    )  # fmt: skip
    theirs, _ = pedpy.compute_voronoi_density(
        individual_voronoi_data=cells, measurement_area=pedpy.MeasurementArea(shapely.box(*area))
    )
    frames = range(0, int(table.frame.max()) + 1, 10)
    density = theirs.set_index("frame").density.reindex(frames, fill_value=0.0)
    assert found == pytest.approx(density.mean(), rel=1e-3)


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("people/pedpy/040_c_56_h-.txt", {"unit": 1}),
        ("people/pedpy/traj_UNI_CORR_500_01.txt", {"unit": 1}),
        ("people/pedpy/trajectories.sqlite", {}),
        ("people/pedpy/vadere_postvis.traj", {"rate": 10}),
    ],
)
def test_published_recordings_are_scored(name, options):
    found = benchnav.score(published(name), radius=0.2, goals="last", quiet=True, **options)
    values = {record.metric: record.value for record in found.records}
    assert values["arrival"] == 1
    assert 0.3 < values["path_length"] / values["time_to_goal"] * 2 < 6


def test_what_cannot_be_asked_for(tmp_path):
    table = rows(("a", 0, (0, 0), (1, 0), 11))
    for options, text in [
        ({"gaps": "brigde"}, r"gaps must be one of refuse, bridge, split.*Did you mean 'bridge'"),
        ({"radius": -1}, r"radius must be > 0\. Got -1"),
        ({"area": [0, 0, 1]}, "area must be xmin, ymin, xmax, ymax"),
        ({"columns": {"ex": "x"}}, "A column must be one of"),
        ({"format": "xml"}, "format must be one of csv, parquet"),
    ]:
        with pytest.raises(UsageError, match=text):
            scored(table, tmp_path, **options)
    with pytest.raises(TrajectoryError, match=r"there must be a column 'X'; the file has time, id"):
        scored(table, tmp_path, columns={"x": "X"})
    with pytest.raises(TrajectoryError, match="rate', in frames a second"):
        scored(table.rename(columns={"time": "frame"}), tmp_path)


NOISY = SCENARIO | {
    "name": "two/noisy",
    "noise": {"rays": {"sensor": "lidar"}, "odometry": {"sensor": "dead-reckoning"}},
    "teams": [
        {
            "name": "crowd", "count": 6, "max_speed": 1.2,
            "footprint": {"type": "capsule", "length": 0.9, "width": 0.4},
            "start": {"type": "circle", "radius": 5, "jitter": 0.3}, "goal": {"type": "antipodal"},
        }
    ],
}  # fmt: skip


@pytest.fixture(scope="module")
def noisy_run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("noisy")
    path = folder / "noisy.yaml"
    path.write_text(yaml.safe_dump(NOISY))
    return path, benchnav.run(
        str(path), navigators=["straight-line"], seeds=1, out=folder / "run", workers=0,
        tracks=["known"], perception=["exact", "noisy"], quiet=True,
    )  # fmt: skip


def test_exact_and_noisy_episodes_of_one_seed_are_two_episodes(noisy_run, tmp_path):
    scenario, made = noisy_run
    (file,) = made.export(tmp_path / "run.csv")
    assert set(pd.read_csv(file).perception) == {"exact", "noisy"}
    scores = benchnav.score(file, scenario=scenario, quiet=True, metrics="path_length").records
    found = {r.perception: r.value for r in scores}
    for record in made.leaderboard(metrics="path_length").records:
        if record.perception in ("exact", "noisy"):
            assert found[record.perception] == pytest.approx(record.value, rel=2e-3)
    assert {"exact", "noisy"} <= set(found)
    assert found["exact"] != found["noisy"]
    one = made.export(tmp_path / "one.csv", perception="noisy")[0]
    assert set(pd.read_csv(one).perception) == {"noisy"}
    files = made.export(tmp_path / "pedpy", to="pedpy")
    assert len({f.name for f in files}) == 4
    assert sum("noisy" in f.name.removeprefix("straight-line-two-noisy") for f in files) == 2
    table = pd.read_csv(one).assign(perception="blurred")
    with pytest.raises(TrajectoryError, match=r"a perception must be one of exact, noisy; got 'bl"):
        scored(table, tmp_path)


@pytest.mark.parametrize("shape", ["columns", "scenario"])
def test_a_body_that_is_not_a_disc_has_the_clearance_of_its_shape(noisy_run, tmp_path, shape):
    scenario, made = noisy_run
    (file,) = made.export(tmp_path / "run.csv", perception="exact")
    table = pd.read_csv(file)
    assert table.body_length.tolist() == [0.9] * len(table)
    assert table.body_width.tolist() == [0.4] * len(table)
    if shape == "scenario":
        table = table.drop(columns=["body_length", "body_width", "corner_radius"])
    found = scored(table, tmp_path, scenario=scenario)
    run = {r.metric: r for r in made.leaderboard(metrics="all").records if r.perception == "exact"}
    for name in ("min_clearance", "personal_space_intimate"):
        assert found[name].value == pytest.approx(run[name].value, rel=2e-3, abs=2e-3)
    for name in ("success", "collided", "collisions_wall", "spl"):
        assert math.isnan(found[name].value)
        assert found[name].fault == "n/a: needs bodies that are discs"
    blind = scored(table.drop(columns="heading"), tmp_path, scenario=scenario)
    assert blind["min_clearance"].fault == "n/a: needs headings"
    disc = scored(table.drop(columns=list(set(table) & {*SHAPE})).assign(radius=0.2), tmp_path)
    assert not math.isnan(disc["collided"].value)
    assert disc["min_clearance"].value != pytest.approx(found["min_clearance"].value)


def test_shapes_that_are_not_there_at_the_same_time_do_not_meet(tmp_path):
    size = {"body_length": 1.0, "body_width": 0.4, "corner_radius": 0.2, "heading": 0.0}
    first, later = ("a", 0, (0, 0), (1, 0), 41), ("b", 5, (0, 0), (1, 0), 41)
    found = scored(rows(first, later).assign(**size), tmp_path)
    assert math.isnan(found["min_clearance"].value)
    behind = rows(first, ("b", 1, (0, 0), (1, 0), 41)).assign(**size)
    assert scored(behind, tmp_path)["min_clearance"].value == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("cells", "text"),
    [
        ({"body_length": 1.0}, "must be given together; body_width, corner_radius is missing"),
        (
            {"body_length": 1.0, "body_width": 0.3, "corner_radius": 0.2},
            ":2: corner_radius must be",
        ),
        (
            {"body_length": 1.0, "body_width": 0.3, "corner_radius": 0.0},
            ":2: corner_radius must be",
        ),
    ],
)
def test_sizes_must_fit(tmp_path, cells, text):
    with pytest.raises(TrajectoryError, match=text):
        scored(rows(("a", 0, (0, 0), (1, 0), 11)).assign(**cells), tmp_path)


def test_recordings_are_scored_in_every_format_that_is_imported(tmp_path, capsys):
    obsmat, ndjson = tmp_path / "obsmat.txt", tmp_path / "tracks.ndjson"
    obsmat.write_text("".join(f"{k} 7 {k / 10} 0 2 0 0 0\n" for k in range(21)))
    ndjson.write_text(
        "".join(f'{{"track": {{"f": {k}, "p": 7, "x": {k / 10}, "y": 2}}}}\n' for k in range(21))
    )
    for path in (obsmat, ndjson):
        found = {r.metric: r.value for r in benchnav.score(path, rate=10, quiet=True).records}
        assert found["path_length"] == pytest.approx(2)
    half = benchnav.score(
        obsmat, rate=10, unit=0.5, format="eth", quiet=True, metrics="path_length"
    )
    assert half.records[0].value == pytest.approx(1)
    obsmat.write_text(
        "# a\n\n" + "".join(f"{k} 7 {k / 10} 0 2 0 0 0\n" for k in range(21) if k != 9)
    )
    with pytest.raises(TrajectoryError, match=r"obsmat\.txt:12: a track must have no gap"):
        benchnav.score(obsmat, rate=10, quiet=True)
    from benchnav.cli.main import status

    for command in (["score", "--help"], ["import", "recording", "--help"]):
        status(command)
        words = "".join(c if c.isalnum() or c == "-" else " " for c in capsys.readouterr().out)
        assert set(FORMATS) <= set(words.replace("- ", "-").split()) | {"pedpy"}, command


MOVERS = [
    {
        "shape": {"type": "box", "width": 0.8}, "count": 2, "region": {"type": "anywhere"},
        "law": {"type": "back-and-forth", "length": 6, "speed": 1},
    }
]  # fmt: skip
RELOCATED = [
    {
        "shape": {"type": "disc", "radius": 0.4}, "count": 1, "relocate_at": 5,
        "region": {"type": "anywhere"},
    }
]  # fmt: skip


def moving(tmp_path, **keys):
    path = tmp_path / "moving.yaml"
    path.write_text(yaml.safe_dump(SCENARIO | {"name": "two/moving"} | keys))
    made = benchnav.run(
        str(path), navigators=["straight-line"], seeds=3, out=tmp_path / "run", workers=0,
        tracks=["known"], salt="5a", quiet=True,
    )  # fmt: skip
    (file,) = made.export(tmp_path / "run.csv")
    return path, made, file


def test_moving_obstacles_are_those_of_the_scenario(tmp_path):
    scenario, made, file = moving(tmp_path, dynamic=MOVERS)
    found = {r.metric: r for r in benchnav.score(file, scenario=scenario, quiet=True).records}
    own = {r.metric: r.value for r in made.leaderboard(metrics="all").records}
    assert own["collisions_dynamic"] > 0.1
    for name in ("min_clearance", "collided", "success", "collisions_dynamic", "contact_time"):
        assert found[name].value == pytest.approx(own[name], rel=0.1, abs=5e-3), name
    later = pd.read_csv(file)
    later.x += 1.0  # no agent of the scenario starts there
    later.to_csv(file, index=False)
    found = {r.metric: r for r in benchnav.score(file, scenario=scenario, quiet=True).records}
    for name in ("min_clearance", "collided", "success", "collisions_dynamic"):
        assert found[name].fault == "n/a: needs moving obstacles"
    assert not found["path_length"].fault


def test_obstacles_that_agents_can_delay_are_unknown(tmp_path, capsys):
    scenario, _, file = moving(tmp_path, static=RELOCATED)
    found = {r.metric: r for r in benchnav.score(file, scenario=scenario).records}
    assert found["min_clearance"].fault == "n/a: needs moving obstacles"
    assert "static obstacles are relocated when agents leave their new places" in (
        capsys.readouterr().err
    )
