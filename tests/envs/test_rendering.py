"""Pictures of environments: of the right size, of the world that is stepped, and moving."""

from itertools import pairwise

import gymnasium
import numpy as np
import pytest

import benchnav
from benchnav.drawing.palette import TEAMS
from benchnav.drawing.top_view import TopView
from benchnav.envs.factory import NoRenderingError
from benchnav.envs.gym.leader_env import LeaderEnv
from benchnav.envs.parallel_env import LeadersEnv
from benchnav.errors import UsageError


def rgb(text):
    return [int(text[n : n + 2], 16) for n in (1, 3, 5)]


@pytest.fixture(scope="module")
def world():
    return benchnav.load_scenario("leaders/dynamic").world(seed=7).record


def test_everything_is_where_it_stands(world):
    """The colour at the centre of each thing, through the frame of the picture."""
    view = TopView(world, 480)
    position = world.agents.start
    bodies = np.array([body.law.points[0] for body in world.bodies])
    picture = view.draw(position, world.agents.heading, bodies, np.ones(4, bool))
    assert max(picture.shape[:2]) == 480
    x0, y0, x1, y1 = world.bounds
    rim = 0.015 * max(x1 - x0, y1 - y0)
    scale = 480 / (max(x1 - x0, y1 - y0) + 2 * rim)

    def at(x, y):
        return picture[int((y1 + rim - y) * scale), int((x - x0 + rim) * scale)].tolist()

    for (x, y), radius, heading in zip(
        position, world.agents.radius, world.agents.heading, strict=True
    ):
        behind = x - 0.5 * radius * np.cos(heading), y - 0.5 * radius * np.sin(heading)
        assert at(*behind) == rgb(TEAMS[0])
    for x, y in bodies:
        assert at(x, y) == rgb("#e07a3f")
    assert at(x0 - 0.5 * rim, 0.5 * (y0 + y1)) == rgb("#36454f")
    assert (picture == 255).all(axis=-1).mean() > 0.6  # the arena is not painted over


def test_the_gymnasium_environment_is_drawn():
    env = gymnasium.wrappers.RenderCollection(
        LeaderEnv("leaders/dynamic", worlds=2, others="straight-line", render_mode="rgb_array")
    )
    with pytest.raises(UsageError, match="call reset"):
        env.unwrapped.render()
    env.reset(seed=0)
    for _ in range(3):
        env.step(np.array([1.0, 0.0], np.float32))
    frames = env.render()
    assert [frame.shape for frame in frames] == [frames[0].shape] * 4
    assert frames[0].dtype == np.uint8
    assert all((one != other).any() for one, other in pairwise(frames))
    assert LeaderEnv("leaders/static", worlds=2, others="orca").render() is None


def test_the_pettingzoo_environment_is_drawn():
    env = LeadersEnv("leaders/static", worlds=2, render_mode="rgb_array")
    with pytest.raises(UsageError, match="call reset"):
        env.render()
    env.reset(seed=0)
    first = env.render()
    env.step({agent: np.array([1.0, 0.5], np.float32) for agent in env.agents})
    assert (env.render() != first).any()
    with pytest.raises(NoRenderingError, match="rgb_array"):
        LeadersEnv("leaders/static", worlds=2, render_mode="human")
