"""The view of an agent whose goal is a waypoint: how a policy that knows goals follows paths."""

from dataclasses import replace

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.navigation.controller import Guide
from benchnav.navigation.observation import Observation


def towards(
    seen: Observation, guide: Guide, tolerance: FloatArray
) -> tuple[Observation, FloatArray]:
    """(what is seen with waypoints for goals, (B, A) [m] tolerance of these).

    A target within the tolerance of the goal is the goal; what is behind any other
    matters, unlike what is behind a goal, so its tolerance is 0. Rays go on seeing the
    real goal and no waypoint: a goal that a ray meets hides the obstacle behind it, which a
    policy passes by as soon as it turns to the next waypoint (`recurrent-ppo`
    succeeded with 82 % of agents in `leaders/static` with waypoints on the rays' layer
    of the goal, 99 % with nothing there, and 100 % with the real goal; 40 validation
    worlds, waypoints up to 3 m ahead on paths of `ompl.rrt-connect`).

    Args:
        seen: one decision's view.
        guide: where the paths say to go.
        tolerance: (B, A) [m] of the goal.
    """
    offset = guide.target - seen.goal
    arriving = np.sum(offset * offset, axis=-1) <= tolerance * tolerance
    goal = np.where(arriving[..., None], seen.goal, guide.target)
    return replace(seen, goal=goal), np.where(arriving, tolerance, 0.0)
