"""Imported maps take part in a run: map → scenario → suite → episodes, by the command."""

import pytest
import yaml

from benchnav.cli.main import status
from benchnav.scenario.load import load_scenario
from benchnav.store.reading import read_results
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


def arrived(folder, scenarios, seeds):
    """{(scenario, navigator): mean share that arrived}; every cell has its whole episodes."""
    suite = folder / "suite.yaml"
    suite.write_text(
        yaml.safe_dump(
            {"name": "imported", "scenarios": scenarios, "navigators": NAVIGATORS, "seeds": seeds}
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
        for navigator in NAVIGATORS:
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
