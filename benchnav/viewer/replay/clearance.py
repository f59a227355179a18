"""The gap between an agent and everything else, at each time of an episode."""

import numpy as np

from benchnav.arena.body import absent
from benchnav.arrays import FloatArray
from benchnav.episode.episode import Episode
from benchnav.metrics.quantities.encounters import things_of
from benchnav.metrics.quantities.episode_analysis import analyse

_ROOM = 2_000_000  # distances that are held at a time


def clearance(episode: Episode, agent: int) -> FloatArray:
    """Return the gaps (T+1,) [m] of an agent to the nearest object; negative for an overlap.

    The objects are walls, obstacles, and other agents that are present; inf: there is none. A body
    that is not a disc counts as the circle around it.
    """
    world = episode.world
    here = episode.position[:, agent]  # (T+1, 2)
    radius = world.agents.radius
    gap = np.full(len(here), np.inf)
    others = np.delete(np.arange(len(radius)), agent)
    if len(others):
        apart = np.linalg.norm(episode.position[:, others] - here[:, None], axis=-1)
        apart -= radius[others]
        gone = analyse(episode).trajectories.leaves[others]
        gap = np.where(np.arange(len(here))[:, None] >= gone, np.inf, apart).min(axis=1)
    things = things_of(world, episode.body_position)
    chunk = max(1, _ROOM // max(1, len(here)))
    for first in range(0, len(things.capsules), chunk):
        part = slice(first, first + chunk)
        capsules, owner = things.capsules[part], things.body[part]
        offset = np.zeros((len(capsules), len(here), 2))
        moving = owner >= 0
        offset[moving] = things.offset[owner[moving]]
        apart = np.where(absent(offset), np.inf, _to_capsules(here[None] - offset, capsules))
        gap = np.minimum(gap, apart.min(axis=0))
    clear: FloatArray = gap - radius[agent]
    return clear


def _to_capsules(points: FloatArray, capsules: FloatArray) -> FloatArray:
    """Return the distances (P, T) [m] of points (P, T, 2) to the rims of capsules (P, 5)."""
    start, way = capsules[:, None, 0:2], capsules[:, None, 2:4] - capsules[:, None, 0:2]
    length2 = np.maximum((way**2).sum(axis=-1), 1e-300)
    along = (((points - start) * way).sum(axis=-1) / length2).clip(0.0, 1.0)
    nearest = start + along[..., None] * way
    distance: FloatArray = np.linalg.norm(points - nearest, axis=-1) - capsules[:, 4:5]
    return distance
