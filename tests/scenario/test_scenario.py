"""What a scenario file may say, and how it is told off."""

import pickle

import pytest

from benchnav.errors import ScenarioError
from benchnav.scenario.load import load_scenario, scenario_from_text
from tests.scenario.files import SHIPPED, SMALL


def complaint(text):
    with pytest.raises(ScenarioError) as caught:
        scenario_from_text(text, "s.yaml")
    return str(caught.value)


def changed(old, new):
    assert old in SMALL
    return SMALL.replace(old, new, 1)


def test_small_is_understood():
    scenario = scenario_from_text(SMALL, "s.yaml")
    assert scenario.identity == "tests/small@1"
    assert [driver.type for driver in scenario.drivers] == ["straight-line"]
    assert scenario.granted_tracks == ("known", "partial", "unknown")
    assert scenario.teams[0].evaluated
    assert not scenario.teams[1].evaluated


@pytest.mark.parametrize("path", SHIPPED, ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_shipped_files(path):
    scenario = load_scenario(path)
    assert scenario.name == f"{path.parent.name}/{path.stem}"
    assert scenario.title
    assert scenario.description
    assert pickle.loads(pickle.dumps(scenario)) == scenario


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("radius: 0.2", "radius: -0.2", "s.yaml:18: teams[0].radius must be > 0; got -0.2."),
        ("radius: 0.2", "radius: .nan", "s.yaml:18: teams[0].radius must be finite; got nan."),
        ("radius: 0.2", "radius: .inf", "s.yaml:18: teams[0].radius must be finite; got inf."),
        ("radius: 0.2", "radius: '0.2'", "s.yaml:18: teams[0].radius must be a number; got '0.2'."),
        ("radius: 0.2", "radius: true", "s.yaml:18: teams[0].radius must be a number; got true."),
        ("radius: 0.2", "radius: [1]",
         "s.yaml:18: teams[0].radius must be a number or one of {uniform: [a, b]},"
         " {normal: [mean, sd, low, high]}, {choice: [a, b, c]}, {integers: [a, b]};"
         " got a list of 1."),
        ("radius: 0.2", "radius: {uniform: [2, 1]}",
         "s.yaml:18: teams[0].radius.uniform must be [low, high] with low ≤ high; got [2, 1]."),
        ("radius: 0.2", "radios: 0.2",
         "s.yaml:18: teams[0].radios is not a known key. Did you mean 'radius'?"),
        ("type: disc, radius: 0.5", "type: dsic, radius: 0.5",
         "s.yaml:7: static[0].shape must have one of the types 'box', 'disc', 'polygon',"
         " 'polyline', 'mesh', 'occupancy'; got 'dsic'. Did you mean 'disc'?"),
        ("type: disc, radius: 0.5", "radius: 0.5",
         "s.yaml:7: static[0].shape must have the key `type`; got a mapping (radius)."),
        ("count: 2", "count: 2.5",
         "s.yaml:17: teams[0].count must be a whole number ≥ 0,"
         " {integers: [a, b]} or {choice: [a, b, c]}."),
        ("count: 2", "count: 5000",
         "s.yaml:16: teams must have at most 5000 agents in all; got up to 5001."),
        ("ignores: [walkers]", "ignores: [walker]",
         "s.yaml:28: teams[1].ignores[0] must be the name of a team; got 'walker'."
         " Did you mean 'walkers'?"),
        ("name: others", "name: walkers",
         "s.yaml:22: teams[1].name must be unique; 'walkers' is teams[0]."),
        ("bounds: [0, 0, 2, 10]", "bounds: [-1, 0, 2, 10]",
         "s.yaml:20: teams[0].start.region must lie within the bounds [0, 0, 10, 10];"
         " it spans x -1 to 2, y 0 to 10."),
        ("bounds: [0, 0, 2, 10]", "bounds: [3, 0, 2, 10]",
         "s.yaml:20: teams[0].start.region.bounds must be [xmin, ymin, xmax, ymax]"
         " with xmin < xmax and ymin < ymax; got [3, 0, 2, 10]."),
        ("points: [[5, 1]]", "points: [[5, 11]]",
         "s.yaml:25: teams[1].start.points[0] must lie within the bounds."),
        ("inner: 2, outer: 3", "inner: 4, outer: 3",
         "s.yaml:13: dynamic[0].region.outer must be ≥ inner (4); got 3."),
        ("    region: {type: anywhere}\n", "",
         "s.yaml:7: static[0] must have either `at` or `region`."),
        ("teams:", "clock: {dt: 0}\nteams:", "s.yaml:15: clock.dt must be > 0; got 0."),
        ("teams:", "clock: {dt: 0.3, horizon: 50}\nteams:",
         "s.yaml:15: clock.horizon must be a whole number of steps of dt = 0.3; got 50,"
         " nearest are 49.8 and 50.1."),
        ("teams:", "rules: {contact: bounce}\nteams:",
         "s.yaml:15: rules.contact must be 'slide', 'stop' or 'end'; got 'bounce'."),
        ("teams:", "layout: {type: maze, columns: 60, rows: 60}\nteams:",
         "s.yaml:15: layout needs cells wider than 0.2 m; 60 × 60 of them in these bounds"
         " are 0.166667 × 0.166667 m."),
        ("    driver: {type: straight-line}\n", "",
         None),
        ("shape: {type: box, width: 1, depth: 2}",
         "shape: {type: polygon, points: [[0, 0], [1, 1], [1, 0], [0, 1]]}",
         "s.yaml:4: walls[0].shape.points must enclose one area without crossing or"
         " touching themselves."),
        ("shape: {type: box, width: 1, depth: 2}",
         "shape: {type: occupancy, file: none.map, format: movingai}",
         "s.yaml:4: walls[0].shape.file must name a file, relative to the scenario's own;"
         " none.map is not one."),
        ("type: disc, radius: 0.5", "type: mesh, file: none.stl",
         "s.yaml:7: static[0].shape.file must name a file, relative to the scenario's own;"
         " none.stl is not one."),
        ("name: tests/small", "name: Tests Small",
         "s.yaml:1: name must match"),
        ("min_distance: 2", "min_distnace: 2",
         "s.yaml:21: teams[0].goal.min_distnace is not a known key. Did you mean 'min_distance'?"),
        ("law: {type: back-and-forth, length: 1, speed: 1}",
         "law: {type: recorded-track, file: a.txt, format: text}",
         "s.yaml:14: dynamic[0].law.frame_time must be given with a `file`."),
    ],
)  # fmt: skip
def test_complaints(old, new, message):
    text = changed(old, new)
    if message is None:
        scenario_from_text(text, "s.yaml")
    else:
        assert complaint(text).startswith(message)


def test_nobody_to_evaluate():
    text = changed("    count: 2\n", "    driver: orca\n")
    assert complaint(text) == (
        "s.yaml:16: teams must hold at least one evaluated agent (a team without `driver`)."
    )


def test_at_most_ten_complaints():
    text = SMALL + "".join(f"key{i}: 1\n" for i in range(15))
    lines = complaint(text).splitlines()
    assert len(lines) == 11
    assert lines[-1] == "… and 5 more."


def test_hash_sees_what_decides_the_worlds_and_nothing_else():
    base = scenario_from_text(SMALL, "s.yaml")
    prose = scenario_from_text(SMALL + "title: Another\n", "elsewhere.yaml")
    explicit = scenario_from_text(SMALL + "walled: true\n", "s.yaml")
    other = scenario_from_text(changed("count: 2", "count: 3"), "s.yaml")
    assert base.hash == prose.hash == explicit.hash
    assert base.hash != other.hash
    assert len(base.hash) == 16


def test_hash_sees_the_bytes_of_files(tmp_path):
    text = changed(
        "shape: {type: disc, radius: 0.3}\n    region: {type: ring, center: [5, 5], inner: 2,"
        " outer: 3}\n    law: {type: back-and-forth, length: 1, speed: 1}",
        "shape: {type: disc, radius: 0.3}\n"
        "    law: {type: recorded-track, file: t.txt, format: text, frame_time: 0.4}",
    )
    (tmp_path / "s.yaml").write_text(text)
    hashes = []
    for rows in ("1 1 2 2\n2 1 2 3\n", "1 1 2 2\n2 1 2 4\n"):
        (tmp_path / "t.txt").write_text(rows)
        hashes.append(load_scenario(tmp_path / "s.yaml").hash)
    assert hashes[0] != hashes[1]
