"""The thickness of thick rays: a key added later, which changes no hash at its default."""

import numpy as np
import pytest

from benchnav.errors import ScenarioError
from benchnav.generation.build import build
from benchnav.generation.world_digest import world_digest
from benchnav.scenario.load import scenario_from_text
from benchnav.store.parts.world_codec import world_from_json, world_to_json

TEXT = """\
name: tests/rays
bounds: [-6, -6, 6, 6]
teams:
  - name: boxes
    count: 2
    max_speed: 1
    footprint: {type: capsule, length: 0.9, width: 0.3}
    start: {type: region, region: {type: anywhere}}
    goal: {type: region, region: {type: anywhere}}
"""


def with_rays(rays):
    return scenario_from_text(f"{TEXT}sensing: {{rays: {rays}}}\n", "rays.yaml")


def test_the_default_changes_neither_hash_nor_digest_nor_stored_form():
    plain, given = with_rays("{count: 7}"), with_rays("{count: 7, thickness: inscribed}")
    assert plain.hash == given.hash
    one, other = build(plain, "test", 0), build(given, "test", 0)
    assert world_digest(one) == world_digest(other)
    assert b"circumscribed" not in world_to_json(one)
    assert not world_from_json(world_to_json(one).decode()).sensing.rays.circumscribed


def test_another_thickness_is_another_scenario_and_comes_back_from_the_store():
    plain, wide = with_rays("{count: 7}"), with_rays("{count: 7, thickness: circumscribed}")
    assert plain.hash != wide.hash
    one, other = build(plain, "test", 0), build(wide, "test", 0)
    assert world_digest(one) != world_digest(other)
    assert np.array_equal(one.agents.start, other.agents.start)
    again = world_from_json(world_to_json(other).decode())
    assert again.sensing == other.sensing
    assert again.sensing.rays.circumscribed


def test_thin_rays_have_no_thickness():
    with pytest.raises(ScenarioError, match="thickness must not be given if `thick` is false"):
        with_rays("{thick: false, thickness: circumscribed}")
