"""One mistake draws one complaint: in scenarios, and in suites and recipes alike."""

import pytest
from pydantic import BaseModel, Field

from benchnav.config.yaml_reader import read_yaml_text, validate
from benchnav.errors import ScenarioError
from benchnav.runner.plan.suite_file import SuiteFile
from benchnav.scenario.load import scenario_from_text
from tests.plain_scenario import PLAIN

SUITE = "name: q\nscenarios: [trap/u]\nnavigators: [orca]\n"
DISC = "{shape: {type: disc, radius: 0.3}"
LAW = "law: {type: circle, radius: 1, speed: 1}"


class Stage(BaseModel):
    decisions: int = Field(gt=0)


class Recipe(BaseModel):
    stages: tuple[Stage, ...] = Field(min_length=1)
    seeds: list[int] = Field(min_length=2)


def refused(text, model=None):
    def load():
        if model is None:
            return scenario_from_text(text, "f.yaml")
        return validate(model, read_yaml_text(text, "f.yaml"))

    with pytest.raises(ScenarioError) as caught:
        load()
    return str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("[[4, 0]]", "[[4, x]]", "f.yaml:8: teams[0].goal.points[0][1] must be a number; got 'x'."),
        ("[[4, 0]]", "[[4]]", "f.yaml:8: teams[0].goal.points[0][1] must be given."),
        ("[[4, 0]]", "[]", "f.yaml:8: teams[0].goal.points must have at least 1 entries; got a list"
         " of 0."),
        ("name: one", "nam: one", "f.yaml:4: teams[0].name must be given.\n"
         "f.yaml:4: teams[0].nam is not a known key. Did you mean 'name'?"),
        ("radius: 0.2", "radius: -1", "f.yaml:5: teams[0].radius must be > 0; got -1."),
        ("teams:", "tracks: [knwon]\nteams:", "f.yaml:3: tracks[0] must be 'known', 'stale',"
         " 'partial' or 'unknown'; got 'knwon'. Did you mean 'known' or 'unknown'?"),
        ("teams:", "walls: [{shape: {type: polygon, points: [[0, 0], [1, 0], [1, y]]}}]\nteams:",
         "f.yaml:3: walls[0].shape.points[2][1] must be a number; got 'y'."),
        ("teams:", f"dynamic: [{DISC}, {LAW}, at: [[1, x]]}}]\nteams:",
         "f.yaml:3: dynamic[0].at[0][1] must be a number; got 'x'."),
        ("radius: 0.2", "radius: 0.2\n    heading: gaol", "f.yaml:6: teams[0].heading must be"
         " 'goal', or a number; got 'gaol'. Did you mean 'goal'?"),
        ("radius: 0.2", "radius: 0.2\n    heading: {uniform: [2, 1]}", "f.yaml:6:"
         " teams[0].heading.uniform must be [low, high] with low ≤ high; got [2, 1]."),
        ("teams:", f"static: [{DISC}, region: {{type: anywhere}}, moved: x}}]\nteams:",
         "f.yaml:3: static[0].moved must be true or false, or a number; got 'x'."),
    ],
)  # fmt: skip
def test_of_a_scenario(old, new, line):
    assert refused(PLAIN.replace(old, new, 1)) == line


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("[orca]", "[5]", "f.yaml:3: navigators[0] must be text, or a mapping; got 5."),
        ("[trap/u]", "[5]", "f.yaml:2: scenarios[0] must be text; got 5."),
        ("[trap/u]", "[]", "f.yaml:2: scenarios must have at least 1 entries; got a list of 0."),
        ("name: q\n", "name: q\nblocks: [{tracks: [kown]}]\n", "f.yaml:2: blocks[0].tracks[0] must"
         " be 'known', 'stale', 'partial' or 'unknown'; got 'kown'. Did you mean 'known' or"
         " 'unknown'?"),
        ("name: q\n", "name: q\nseeds: [1]\n", "f.yaml:2: seeds must be a whole number, or text;"
         " got a list of 1."),
    ],
)  # fmt: skip
def test_of_a_suite(old, new, line):
    assert refused(SUITE.replace(old, new, 1), SuiteFile) == line


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("stages: [{decisions: 0}]\nseeds: [1, 2]", "f.yaml:1: stages[0].decisions must be > 0; got"
         " 0."),
        ("stages: [{decisions: 1}]\nseeds: [1, x]", "f.yaml:2: seeds[1] must be a whole number; got"
         " 'x'."),
    ],
)  # fmt: skip
def test_of_any_other_file(text, line):
    assert refused(text, Recipe) == line


def test_more_than_ten_are_counted():
    points = ", ".join("[x, 1]" for _ in range(30))
    lines = refused(PLAIN.replace("[4, 0]", points)).splitlines()
    assert len(lines) == 11
    assert lines[-1] == "… and 20 more."
