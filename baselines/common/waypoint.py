"""Observations with a waypoint as goal: how a policy that knows goals follows paths."""

from dataclasses import replace

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.navigation import Guide, Observation


def towards(
    observation: Observation, guide: Guide, tolerance: FloatArray
) -> tuple[Observation, FloatArray]:
    """Return (observation with waypoints as goals, their tolerance (B, A) [m]).

    A target within the tolerance of the goal is the goal. Obstacles behind any other target
    matter, unlike obstacles behind a goal, so its tolerance is 0. Rays still report the
    real goal and no waypoint: a goal that a ray hits hides the obstacle behind it, which a
    policy passes as soon as it turns to the next waypoint (`recurrent-ppo`
    succeeded with 82 % of agents in `leaders/static` with waypoints on the rays' layer
    of the goal, 99 % with an empty layer, and 100 % with the real goal; 40 validation
    worlds, waypoints up to 3 m ahead on paths of `ompl.rrt-connect`).

    Args:
        observation: of one decision.
        guide: the targets of the paths.
        tolerance: (B, A) [m] of the goal.
    """
    offset = guide.target - observation.goal
    arriving = np.sum(offset * offset, axis=-1) <= tolerance * tolerance
    goal = np.where(arriving[..., None], observation.goal, guide.target)
    return replace(observation, goal=goal), np.where(arriving, tolerance, 0.0)
