"""Pictures of worlds and episodes as SVG."""

from xml.etree import ElementTree

import numpy as np

import benchnav
from benchnav.arena import Kind
from benchnav.drawing.palette import FILL
from benchnav.testing.zoo import zoo
from benchnav.viewer.svg import episode_svg, world_svg
from benchnav.world.simulation import Simulation

CIRCLE = "{http://www.w3.org/2000/svg}circle"


def circles(text):
    found = ElementTree.fromstring(text).iter(CIRCLE)
    return {(float(c.get("cx")), float(c.get("cy"))) for c in found}


def test_a_world_has_its_agents_goals_and_moving_obstacles():
    world = benchnav.load_scenario("leaders/dynamic").world().record
    drawn = world_svg(world)
    for x, y in (*world.agents.start, *world.agents.goal):
        assert (round(float(x), 3), round(float(y), 3)) in circles(drawn)
    moving = [body.solid for body in world.bodies if body.solid.kind == Kind.DYNAMIC]
    assert drawn.count(f'fill="{FILL[Kind.DYNAMIC]}"') == len(moving) > 0
    first = moving[0].loops[0] + Simulation([world]).body_position[0, 0]
    assert f"M {first[0, 0]:.3f},{first[0, 1]:.3f} " in drawn


def test_an_episode_has_the_path_of_every_agent():
    world = benchnav.load_scenario("circle/antipodal").world()
    episode = benchnav.simulate(world, "straight-line")
    paths = ElementTree.fromstring(episode.svg()).iter("{http://www.w3.org/2000/svg}polyline")
    first = [path.get("points").split()[0] for path in paths]
    starts = np.round(world.record.agents.start, 3)
    assert first == [f"{x:.3f},{y:.3f}" for x, y in starts]


def test_agents_that_enter_later_are_not_filled_and_those_that_did_not_are_left_out():
    late = zoo()["late"]
    assert world_svg(late.world).count('fill="#fff"') == 2
    text = episode_svg(late)
    assert 'fill="#fff"' not in text
    x, y = late.world.agents.start[2]
    assert (x, y) not in circles(text)
