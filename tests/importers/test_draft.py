import shutil
from pathlib import Path

import numpy as np
import pytest
import yaml

from benchnav.errors import MapError, UsageError
from benchnav.generation.build import build
from benchnav.runner.rollouts.rollout import Assignment, rollout
from benchnav.scenario.files.occupancy import occupancy_solids, read_occupancy
from benchnav.scenario.importers import (
    default_name,
    import_movingai,
    import_ros_map,
    write_scenario,
)
from benchnav.scenario.load import load_scenario
from tests.importers.data import published

MAP = "type octile\nheight 4\nwidth 5\nmap\n.....\n.@T..\nG.OW.\n@...S\n"
QUERIES = [
    (0, (0, 0), (4, 3)), (1, (0, 0), (1, 0)), (1, (0, 2), (4, 3)), (1, (0, 2), (1, 2)),
    (1, (3, 0), (3, 0)), (2, (4, 0), (4, 1)),
]  # fmt: skip


@pytest.fixture
def tiny(tmp_path):
    (tmp_path / "from").mkdir()
    path = tmp_path / "from" / "Tiny Map!.map"
    path.write_text(MAP)
    rows = [
        f"{bucket}\t{path.name}\t5\t4\t{a}\t{b}\t{c}\t{d}\t1" for bucket, (a, b), (c, d) in QUERIES
    ]
    path.with_suffix(".scen").write_text("\n".join(["version 1", *rows, ""]))
    return path


@pytest.fixture
def ros(tmp_path):
    folder = tmp_path / "lab"
    (folder / "images").mkdir(parents=True)
    (folder / "images" / "lab.pgm").write_bytes(
        b"P5\n40 20\n255\n" + bytes([254] * 790) + bytes(5) + bytes([205] * 5)
    )
    path = folder / "lab.yaml"
    path.write_text(
        "image: images/lab.pgm\nresolution: 0.5\norigin: [1, 2, 0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    return path


def test_the_first_queries_with_starts_and_goals_of_their_own(tiny):
    mapping = import_movingai(tiny, tiny.with_suffix(".scen"), agents=3)
    (team,) = mapping["teams"]
    assert team["count"] == 3
    assert team["start"]["points"] == [[0.5, 3.5], [0.5, 1.5], [4.5, 3.5]]
    assert team["goal"]["points"] == [[4.5, 0.5], [1.5, 1.5], [4.5, 2.5]]
    assert team["radius"] == pytest.approx(0.3)
    assert mapping["bounds"] == [0.0, 0.0, 5.0, 4.0]
    one = import_movingai(tiny, tiny.with_suffix(".scen"), agents=1, bucket=2, cell=2.0)
    assert one["teams"][0]["start"]["points"] == [[9.0, 7.0]]
    assert one["teams"][0]["radius"] == pytest.approx(0.6)


def test_what_cannot_be_asked_for(tiny, tmp_path):
    scen = tiny.with_suffix(".scen")
    with pytest.raises(MapError, match=r"4 queries with different .*; there are 3\. Request fewer"):
        import_movingai(tiny, scen, agents=4)
    with pytest.raises(MapError, match=r"2 queries in bucket 7 .* there are 0\. .* 0 to 2"):
        import_movingai(tiny, scen, agents=2, bucket=7)
    with pytest.raises(UsageError, match=r"A bucket needs a \.scen file; got bucket 1"):
        import_movingai(tiny, bucket=1)
    with pytest.raises(UsageError, match="agents must be ≥ 1; got 0"):
        import_movingai(tiny, agents=0)
    with pytest.raises(UsageError, match="radius must be > 0 m; got -1"):
        import_movingai(tiny, radius=-1)
    full = tmp_path / "full.map"
    full.write_text("type octile\nheight 1\nwidth 1\nmap\n@\n")
    with pytest.raises(MapError, match="must have a free cell"):
        import_movingai(full)


def test_what_is_written_loads_alone(tiny, tmp_path):
    out = tmp_path / "to" / "deep" / "tiny.yaml"
    files = write_scenario(import_movingai(tiny, tiny.with_suffix(".scen"), agents=3), out)
    assert files == [out, out.parent / tiny.name]
    shutil.rmtree(tiny.parent)
    scenario = load_scenario(out)
    assert scenario.name == "movingai/tiny-map"
    assert yaml.safe_load(out.read_text())["walls"][0]["shape"]["file"] == tiny.name
    solids, bounds = occupancy_solids(out.parent / tiny.name, "movingai")
    assert bounds == tuple(scenario.bounds)
    assert sum(len(s.capsules) for s in solids) > 4


def test_a_ros_map_takes_its_image_along(ros, tmp_path):
    out = tmp_path / "to" / "lab-scenario.yaml"
    files = write_scenario(import_ros_map(ros, agents=4), out)
    assert [f.name for f in files] == ["lab-scenario.yaml", "lab.yaml", "lab.pgm"]
    shutil.rmtree(ros.parent)
    scenario = load_scenario(out)
    assert scenario.name == "ros/lab"
    assert scenario.bounds == (1.0, 2.0, 21.0, 12.0)
    solids, _ = occupancy_solids(out.parent / "lab.yaml", "ros")
    assert np.vstack([s.capsules for s in solids])[:, :2].max(axis=0).tolist() == [21.0, 12.0]
    assert (
        "unknown_is_free" not in import_ros_map(tmp_path / "to" / "lab.yaml")["walls"][0]["shape"]
    )


def test_no_scenario_is_overwritten_unless_forced(tiny, tmp_path):
    out = tmp_path / "to" / "tiny.yaml"
    mapping = import_movingai(tiny)
    write_scenario(mapping, out)
    before = out.read_text()
    with pytest.raises(
        UsageError, match=r"tiny\.yaml must not exist yet; the option 'force' overwrites it"
    ):
        write_scenario({**mapping, "title": "other"}, out)
    assert out.read_text() == before
    write_scenario({**mapping, "title": "other"}, out, force=True)
    assert "other" in out.read_text()
    assert sorted(path.name for path in out.parent.iterdir()) == [tiny.name, "tiny.yaml"]


def test_beside_its_map_a_scenario_copies_nothing(ros, tiny):
    files = write_scenario(import_movingai(tiny), tiny.parent / "tiny.yaml")
    assert files == [tiny.parent / "tiny.yaml", tiny]
    for force in (False, True):
        with pytest.raises(UsageError, match=r"lab\.yaml is the map's own name"):
            write_scenario(import_ros_map(ros), ros, force)


def test_where_nothing_can_be_written(tiny, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(UsageError, match="is not writable"):
        write_scenario(import_movingai(tiny), tmp_path / "file" / "tiny.yaml")


@pytest.mark.parametrize("name", ["room-32-32-4", "maze-32-32-2", "Berlin_1_256"])
def test_published_movingai_maps_become_scenarios(name, tmp_path):
    path = published(f"movingai/{name}.map")
    scen = published(f"movingai/{name}-even-1.scen")
    out = tmp_path / "scenario.yaml"
    write_scenario(import_movingai(path, scen, agents=20), out)
    assert load_scenario(out).teams[0].count == 20


@pytest.mark.parametrize("name", ["depot", "tb3_sandbox", "turtlebot3/map", "testmap"])
def test_published_ros_maps_become_scenarios(name, tmp_path):
    path = published(f"ros_maps/{name}.yaml")
    write_scenario(import_ros_map(path), tmp_path / "scenario.yaml")
    scenario = load_scenario(tmp_path / "scenario.yaml")
    assert (scenario.teams[0].count == 20) == (name == "depot")
    assert scenario.teams[0].count >= 2
    worlds = [build(scenario, "test", seed) for seed in range(3)]
    least = scenario.teams[0].goal.min_distance
    for world in worlds:
        assert world.redraws < 5
        way = world.agents.goal - world.agents.start
        assert np.hypot(way[:, 0], way[:, 1]).min() >= least > 2 * world.agents.radius[0]
    assignment = Assignment(
        scenario.identity, scenario.hash, "test", "known", "straight-line", "straight-line"
    )
    (episodes,) = rollout(assignment, list(enumerate(worlds)))
    assert [episode.failure for episode in episodes] == [""] * 3


def test_agents_are_as_large_and_as_many_as_a_map_has_room_for(ros, tmp_path):
    full = import_ros_map(ros)["teams"][0]
    assert (full["count"], full["radius"]) == (20, 0.2)
    few = np.full((20, 20), 205, np.uint8)  # unknown but for 2 × 1 m
    few[4:14, 10:15] = 254
    (ros.parent / "images" / "lab.pgm").write_bytes(b"P5\n20 20\n255\n" + few.tobytes())
    ros.write_text(ros.read_text().replace("resolution: 0.5", "resolution: 0.2"))
    team = import_ros_map(ros, radius=0.1)["teams"][0]
    assert team["start"]["region"]["bounds"] == pytest.approx([3, 3.2, 4, 5.2])
    assert team["count"] == int(2.0 / 0.36)
    assert team["goal"]["min_distance"] == pytest.approx(0.25)
    small = import_ros_map(ros)["teams"][0]
    assert (small["count"], small["radius"]) == (5, 0.1)  # for 0.2 m there is room for one
    assert import_ros_map(ros, agents=3)["teams"][0]["count"] == 3
    with pytest.raises(MapError, match=r"a radius of 0\.6 m of free space\. Try a smaller"):
        import_ros_map(ros, radius=0.6)
    with pytest.raises(UsageError, match="radius must be > 0 m; got 0"):
        import_ros_map(ros, radius=0)


def warehouse(folder, pillar):
    """A map that is called as map_saver calls every map, with a pillar in some column."""
    folder.mkdir(parents=True)
    shades = np.full((20, 40), 254, np.uint8)
    shades[9:11, pillar] = 0
    (folder / "map.pgm").write_bytes(b"P5\n40 20\n255\n" + shades.tobytes())
    (folder / "map.yaml").write_text(
        "image: map.pgm\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    return folder / "map.yaml"


def pillar_of(scenario):
    """Column of the cells that the scenario's map blocks."""
    shape = load_scenario(scenario).walls[0].shape
    return int(np.nonzero(read_occupancy(scenario.parent / shape.file, "ros").blocked)[1][0])


@pytest.mark.parametrize("force", [False, True])
def test_maps_of_one_name_stand_side_by_side(tmp_path, force):
    for name, pillar in (("a", 10), ("b", 20), ("c", 30)):
        mapping = import_ros_map(warehouse(tmp_path / name, pillar), agents=2)
        write_scenario(mapping, tmp_path / "to" / f"{name}.yaml", force)
        write_scenario(mapping, tmp_path / "to" / f"{name}.yaml", True)  # once more adds nothing
    assert [pillar_of(tmp_path / "to" / f"{name}.yaml") for name in "abc"] == [10, 20, 30]
    assert len({load_scenario(tmp_path / "to" / f"{name}.yaml").name for name in "abc"}) == 3
    assert len(list((tmp_path / "to").iterdir())) == 9


def test_no_map_takes_the_name_of_a_scenario(tmp_path):
    mapping = import_ros_map(warehouse(tmp_path / "a", 10), agents=2)
    files = write_scenario(mapping, tmp_path / "to" / "map.yaml")
    assert [file.name for file in files] == ["map.yaml", "map-map.yaml", "map.pgm"]
    assert pillar_of(tmp_path / "to" / "map.yaml") == 10
    write_scenario(mapping, tmp_path / "to" / "a.yaml")  # where map.yaml is a scenario
    assert pillar_of(tmp_path / "to" / "a.yaml") == pillar_of(tmp_path / "to" / "map.yaml") == 10


def test_a_scenario_overwrites_no_map_of_another_one(tmp_path):
    write_scenario(import_ros_map(warehouse(tmp_path / "a", 10), agents=2), tmp_path / "a.yaml")
    other = import_ros_map(warehouse(tmp_path / "b", 20), agents=2)
    for name in ("map.yaml", "map.pgm"):
        with pytest.raises(UsageError, match=rf"{name} is not a scenario; give the new scenario"):
            write_scenario(other, tmp_path / name, force=True)
    assert pillar_of(tmp_path / "a.yaml") == 10


def test_a_map_that_has_changed_is_copied_anew_and_the_old_one_stays(tmp_path):
    path = warehouse(tmp_path / "a", 10)
    write_scenario(import_ros_map(path, agents=2), tmp_path / "to" / "one.yaml")
    shutil.rmtree(path.parent)
    warehouse(path.parent, 20)
    write_scenario(import_ros_map(path, agents=2), tmp_path / "to" / "two.yaml", force=True)
    assert pillar_of(tmp_path / "to" / "one.yaml") == 10
    assert pillar_of(tmp_path / "to" / "two.yaml") == 20


def test_names_tell_maps_apart(tmp_path, tiny):
    assert default_name("ros", tmp_path / "maps" / "002" / "map.yaml") == "ros/002"
    assert default_name("ros", tmp_path / "Map.yaml", tmp_path / "Lab 2.yaml") == "ros/lab-2"
    assert default_name("ros", tmp_path / "b" / "map.yaml", tmp_path / "map.yaml") == "ros/b"
    assert default_name("ros", Path("/maps/map.yaml")) == "ros/map"
    assert import_movingai(tiny, name="mine/hall_2")["name"] == "mine/hall_2"
    for name in ("My Hall", "mine/", "ä", "a" * 101, ""):
        with pytest.raises(UsageError, match="A scenario's name must consist of small letters"):
            import_movingai(tiny, name=name)


def test_a_map_without_a_free_cell_tells_blocked_from_unknown(ros, tmp_path):
    image = ros.parent / "images" / "lab.pgm"
    image.write_bytes(b"P5\n40 20\n255\n" + bytes([205] * 790) + bytes(10))
    says = r"none is free, 10 are blocked and 790 are unknown\. The option 'unknown-is-free' opens"
    with pytest.raises(MapError, match=says):
        import_ros_map(ros)
    open_to_all = import_ros_map(ros, unknown_is_free=True)
    assert open_to_all["walls"][0]["shape"]["unknown_is_free"] is True
    with pytest.raises(MapError, match=r"10 are blocked and 790 are unknown\. `unknown_is_free: t"):
        occupancy_solids(ros, "ros")
    image.write_bytes(b"P5\n40 20\n255\n" + bytes(800))
    with pytest.raises(MapError, match="all 800 are blocked"):
        import_ros_map(ros, unknown_is_free=True)


def test_remarks_on_cells_and_journeys(ros, tiny):
    remarks = []
    import_movingai(tiny, tiny.with_suffix(".scen"), agents=3, cell=0.5, remark=remarks.append)
    assert remarks == [
        "5 × 4 cells of 0.5 m: 15 free, 5 blocked, 0 unknown.",
        "3 journeys: shortest 0.5 m, median 0.5 m, longest 0.5 m.",
    ]
    remarks.clear()
    import_ros_map(ros, remark=remarks.append)
    assert remarks[:2] == [
        "40 × 20 cells of 0.5 m: 790 free, 5 blocked, 5 unknown.",
        "Agents may not enter unknown cells; the option 'unknown-is-free' opens them.",
    ]
    ros.write_text(ros.read_text().replace("0.196", "0.25"))
    remarks.clear()
    import_ros_map(ros, remark=remarks.append)
    assert remarks[0] == "40 × 20 cells of 0.5 m: 795 free, 5 blocked, 0 unknown."
    assert remarks[1].startswith("5 free cells have the grey 205")
    assert "set the map's free_thresh to 0.196" in remarks[1]
    assert max(len(line) for remark in remarks for line in remark.splitlines()) <= 80


def test_a_map_of_walls_only_asks_which_shade_is_an_obstacle(ros):
    image = ros.parent / "images" / "lab.pgm"
    image.write_bytes(b"P5\n40 20\n255\n" + bytes(770) + bytes([254] * 30))
    remarks = []
    import_ros_map(ros, agents=1, remark=remarks.append)
    assert remarks[1].startswith(
        "96 % of the known cells are blocked. If light pixels are obstacles"
    )
    assert max(len(line) for line in remarks[1].splitlines()) <= 80


def test_the_image_counts_whatever_the_map_file_is_called(tmp_path):
    path = warehouse(tmp_path / "a", 10)
    write_scenario(import_ros_map(path.rename(path.with_name("map.YAML"))), tmp_path / "a.yaml")
    assert set(load_scenario(tmp_path / "a.yaml").named_files()) == {"map.YAML", "map.pgm"}
    before = load_scenario(tmp_path / "a.yaml").hash
    pixels = (tmp_path / "map.pgm").read_bytes()
    (tmp_path / "map.pgm").write_bytes(pixels[:-1] + bytes([0]))
    assert load_scenario(tmp_path / "a.yaml").hash != before
