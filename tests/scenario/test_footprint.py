"""The team key footprint: sizes, errors, hashes, and worlds with it."""

import numpy as np
import pytest

from benchnav.errors import ScenarioError
from benchnav.generation.build import build
from benchnav.generation.world_digest import world_digest
from benchnav.scenario.load import load_scenario
from benchnav.store.parts.world_codec import world_from_json, world_to_json

TEXT = """\
name: tests/bodies
bounds: [0, 0, 12, 12]
teams:
  - name: one
    {body}
    max_speed: 1
    count: 4
    start: {{type: region, region: {{type: anywhere}}}}
    goal: {{type: region, region: {{type: anywhere}}}}
"""
CAPSULE = "footprint: {type: capsule, length: {uniform: [0.8, 1.2]}, width: 0.4}"
BOX = "footprint: {type: rounded-box, length: 0.5, width: 0.8, corner_radius: 0.1}"


@pytest.fixture
def load(tmp_path):
    def from_body(body):
        path = tmp_path / "s.yaml"
        path.write_text(TEXT.format(body=body))
        return load_scenario(path)

    return from_body


def test_sizes_are_drawn_and_the_radius_follows(load):
    agents = build(load(CAPSULE), "test", 0).agents
    assert len(set(agents.half_length)) == 4
    assert ((agents.half_length >= 0.4) & (agents.half_length <= 0.6)).all()
    assert (agents.radius == agents.half_length).all()
    assert (agents.rounding == 0.2).all()
    assert (agents.inner_radius == 0.2).all()
    box = build(load(BOX), "test", 0).agents
    assert box.radius == pytest.approx(np.hypot(0.15, 0.3) + 0.1)
    assert (box.inner_radius == 0.25).all()


def test_a_disc_by_footprint_is_the_disc_by_radius(load):
    one = build(load("radius: 0.3"), "test", 3)
    same = build(load("footprint: {type: disc, radius: 0.3}"), "test", 3)
    assert world_digest(one) == world_digest(same)
    assert b"half_length" not in world_to_json(one)


def test_a_world_survives_its_stored_form(load):
    world = build(load(BOX), "test", 1)
    again = world_from_json(world_to_json(world).decode())
    assert world_digest(again) == world_digest(world)
    assert world_digest(world) != world_digest(build(load("radius: 0.4354"), "test", 1))


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("heading: goal", "s.yaml:4: teams[0].radius must be given, or `footprint` for other"
         " shapes, or `robot`."),
        ("radius: 0.3\n    " + CAPSULE, "s.yaml:5: teams[0].radius must be left out, because it"
         " follows from `footprint`; remove one."),
        ("footprint: {type: capsule, length: 0.3, width: 0.4}",
         "s.yaml:5: teams[0].footprint.length must be ≥ width (0.4); got 0.3. Use"
         " `type: rounded-box` for a body that is wider than long."),
        ("footprint: {type: rounded-box, length: 0.5, width: 0.3, corner_radius: 0.2}",
         "s.yaml:5: teams[0].footprint.corner_radius must be ≤ half of width (0.15); got 0.2."),
        ("footprint: {type: capsule, length: 0.5, width: 0}",
         "s.yaml:5: teams[0].footprint.width must be > 0; got 0."),
        ("footprint: {type: ellipse, length: 0.5}",
         "s.yaml:5: teams[0].footprint must have one of the types 'disc', 'capsule',"
         " 'rounded-box'; got 'ellipse'."),
    ],
)  # fmt: skip
def test_bad_footprints_are_one_sentence_with_its_place(load, body, message):
    with pytest.raises(ScenarioError) as error:
        load(body)
    assert str(error.value).endswith(message)


def test_a_footprint_larger_than_its_start_region_says_so(tmp_path):
    path = tmp_path / "s.yaml"
    text = TEXT.format(body=BOX.replace("length: 0.5", "length: 20")).replace(
        "bounds", "walled: true\nbounds"
    )
    path.write_text(text)
    with pytest.raises(ScenarioError) as error:
        load_scenario(path)
    assert "teams[0].start must have room for all of 'one', up to 4 agents" in str(error.value)
    assert "no circle of radius 10 m fits into the region" in str(error.value)
    assert "Enlarge the region, or shrink the footprint." in str(error.value)
