"""Imported maps take part in a run: map → scenario → suite → episodes, by the command."""

import numpy as np
import pytest
import yaml

from benchnav.cli.main import status
from benchnav.scenario.load import load_scenario
from benchnav.store.runs.reading import read_results
from tests.importers.data import published

pytest.importorskip("ompl")

NAVIGATORS = ["orca", "ompl-orca"]

# Two halls, joined by a passage in the middle; every straight way from hall to hall is closed.
HALLS = """\
type octile
height 9
width 15
map
@@@@@@@@@@@@@@@
@......@......@
@......@......@
@......@......@
@.............@
@......@......@
@......@......@
@......@......@
@@@@@@@@@@@@@@@
"""
# columns and rows of starts and goals, counted from above
WAYS = [((1, 1), (13, 1)), ((1, 7), (13, 7)), ((2, 1), (12, 2)), ((13, 6), (1, 6))]


def halls(folder):
    path = folder / "halls.map"
    path.write_text(HALLS)
    rows = [f"0\thalls.map\t15\t9\t{a}\t{b}\t{c}\t{d}\t15" for (a, b), (c, d) in WAYS]
    path.with_suffix(".scen").write_text("\n".join(["version 1", *rows, ""]))
    return path


def arrived(folder, scenarios, seeds, navigators=NAVIGATORS):
    """{(scenario, navigator): mean share that arrived}; every cell has its whole episodes."""
    suite = folder / "suite.yaml"
    suite.write_text(
        yaml.safe_dump(
            {"name": "imported", "scenarios": scenarios, "navigators": navigators, "seeds": seeds}
        )
    )
    run = folder / "run"
    assert status(["run", str(suite), "--out", str(run), "--quiet"]) == 0
    table = read_results(run).to_pandas()
    assert set(table.failure) == {""}
    table = table[table.metric == "arrival"]
    shares = {}
    for scenario in scenarios:
        team = load_scenario(folder / scenario).teams[0]
        for navigator in navigators:
            mine = table[
                (table.scenario == load_scenario(folder / scenario).identity)
                & (table.navigator == navigator)
            ]
            assert sorted(mine.seed) == list(range(seeds))
            assert set(mine.agents) == {team.count}
            shares[scenario, navigator] = float(mine.value.mean())
    print(shares)
    return shares


def imported(*arguments):
    assert status(["import", *(str(argument) for argument in arguments)]) == 0


def test_a_map_of_our_own_runs_from_import_to_table(tmp_path):
    path = halls(tmp_path)
    out = tmp_path / "to" / "halls.yaml"
    scen = path.with_suffix(".scen")
    imported("movingai", path, "--scen", scen, "--agents", 4, "--out", out)
    shares = arrived(out.parent, ["halls.yaml"], 2)
    assert shares["halls.yaml", "orca"] < shares["halls.yaml", "ompl-orca"] == 1.0


def saved_map(folder, free_column):
    """A map as map_saver names and writes it, with one free room in unknown surroundings."""
    folder.mkdir()
    shades = np.full((30, 60), 205, np.uint8)
    shades[:, free_column : free_column + 30] = 254
    shades[14:16, free_column + 10] = 0
    (folder / "map.pgm").write_bytes(b"P5\n60 30\n255\n" + shades.tobytes())
    (folder / "map.yaml").write_text(
        "image: map.pgm\nmode: Trinary\nresolution: '0.2'\norigin: [0, 0, 0]\nnegate: no\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    return folder / "map.yaml"


def test_two_maps_of_one_name_run_in_one_suite(tmp_path, capsys):
    out = tmp_path / "w"
    for name, column in (("a", 0), ("b", 30)):
        path = saved_map(tmp_path / name, column)
        imported("ros-map", path, "--agents", 2, "--out", out / f"{name}.yaml", "--force")
    stdout, stderr = capsys.readouterr()
    files = ["a.yaml", "map.yaml", "map.pgm", "b.yaml", "b-map.yaml", "b-map.pgm"]
    assert stdout.splitlines() == [str(out / file) for file in files]
    assert stderr.splitlines()[0] == "60 × 30 cells of 0.2 m: 898 free, 2 blocked, 900 unknown."
    assert max(map(len, stderr.splitlines())) <= 80
    shares = arrived(out, ["a.yaml", "b.yaml"], 1, ["orca"])
    assert len(shares) == 2


def test_a_map_that_cannot_be_imported_is_refused_in_one_sentence(tmp_path, capsys):
    path = saved_map(tmp_path / "a", 0)
    path.write_text(path.read_text().replace("0.196", "0.001"))
    assert status(["import", "ros-map", str(path), "--out", str(tmp_path / "s.yaml")]) == 2
    stdout, stderr = capsys.readouterr()
    assert stdout == ""
    assert stderr.endswith(
        "none is free, 2 are blocked and 1798 are unknown. --unknown-is-free opens unknown"
        " cells to agents.\n"
    )
    open_to_all = ["import", "ros-map", str(path), "--out", str(tmp_path / "s.yaml")]
    assert status([*open_to_all, "--unknown-is-free", "--name", "lab/hall"]) == 0
    assert "Agents may enter unknown cells." in capsys.readouterr().err
    assert load_scenario(tmp_path / "s.yaml").name == "lab/hall"


@pytest.mark.slow
def test_depot_and_rooms_run_with_twenty_agents(tmp_path):
    rooms = published("movingai/room-32-32-4.map")
    queries = published("movingai/room-32-32-4-even-1.scen")
    depot = published("ros_maps/depot.yaml")
    out = tmp_path / "to"
    imported("movingai", rooms, "--scen", queries, "--agents", 20, "--out", out / "rooms.yaml")
    imported("ros-map", depot, "--agents", 20, "--out", out / "warehouse.yaml")
    shares = arrived(out, ["rooms.yaml", "warehouse.yaml"], 2)
    assert shares["rooms.yaml", "ompl-orca"] >= shares["rooms.yaml", "orca"] + 0.3
    assert shares["warehouse.yaml", "ompl-orca"] >= max(shares["warehouse.yaml", "orca"], 0.8)
