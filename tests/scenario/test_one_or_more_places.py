"""`at` takes one point or a list of points, in walls, static and dynamic groups alike."""

import json

import jsonschema
import numpy as np
import pytest
import yaml

from benchnav.errors import ScenarioError
from benchnav.generation.build import build
from benchnav.scenario.load import json_schema, scenario_from_text
from tests.plain_scenario import PLAIN

DISC = "shape: {type: disc, radius: 0.3}"
PARTS = {
    "walls": f"{{{DISC}, at: AT}}",
    "static": f"{{{DISC}, at: AT}}",
    "dynamic": f"{{{DISC}, law: {{type: circle, radius: 0.5, speed: 1, phase: 0}}, at: AT}}",
}


def loaded(key, at):
    text = f"{PLAIN}{key}: [{PARTS[key].replace('AT', at)}]\n"
    jsonschema.validate(json.loads(json.dumps(yaml.safe_load(text))), json_schema())
    return scenario_from_text(text, "s.yaml")


def centres(world):
    solids = [tuple(solid.center) for solid in world.solids if solid.is_disc]
    bodies = [tuple(body.law.points[0]) for body in world.bodies]
    return sorted(solids + bodies)


@pytest.mark.parametrize("key", PARTS)
def test_one_point_is_a_list_of_one(key):
    one, other = (build(loaded(key, at), "test", 0) for at in ("[1, 2]", "[[1, 2]]"))
    np.testing.assert_allclose(centres(one), centres(other))
    assert len(centres(one)) == 1


@pytest.mark.parametrize("key", PARTS)
def test_something_stands_at_each_point(key):
    world = build(loaded(key, "[[1, 2], [-1, -3], [2, -2]]"), "test", 0)
    assert len(centres(world)) == 3


def test_walls_may_be_shaken_at_each_point():
    world = build(loaded("walls", "[[1, {uniform: [2, 3]}], [-1, {uniform: [-3, -2]}]]"), "test", 0)
    (_, low), (_, high) = centres(world)
    assert -3 <= low <= -2
    assert 2 <= high <= 3


@pytest.mark.parametrize(
    ("key", "at", "complaint"),
    [
        ("walls", "[]", "walls[0].at must have at least 1 entries; got a list of 0."),
        ("walls", "[1]", "walls[0].at[1] must be given."),
        ("walls", "[[1, 2], 3]", "walls[0].at[1] must be a list; got 3."),
        ("walls", "[[1, 2], [x, 3]]", "walls[0].at[1][0] must be a number; got 'x'."),
        ("static", "[1, x]", "static[0].at[1] must be a number; got 'x'."),
        ("static", "[0, 20]", "static[0].at must lie within the bounds."),
        ("dynamic", "[[0, 1], [0, 20]]", "dynamic[0].at[1] must lie within the bounds."),
        ("dynamic", "3", "dynamic[0].at must be a list; got 3."),
    ],
)
def test_wrong_places_are_named(key, at, complaint):
    with pytest.raises(ScenarioError) as caught:
        scenario_from_text(f"{PLAIN}{key}: [{PARTS[key].replace('AT', at)}]\n", "s.yaml")
    assert str(caught.value) == f"s.yaml:9: {complaint}"
