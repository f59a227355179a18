"""The gap between an agent and everything else, at each time of an episode."""

import numpy as np

from benchnav.arena.body import absent
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.episode.episode import Episode
from benchnav.geometry.rotation import cos_sin
from benchnav.kernels import kernel
from benchnav.metrics.quantities.encounters import things_of
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.metrics.quantities.footprint_gaps import cores_apart, shapes_of
from benchnav.world.bodies import is_away

_ROOM = 2_000_000  # distances that are held at a time


def clearance(episode: Episode, agent: int) -> FloatArray:
    """Return the gaps (T+1,) [m] of an agent to the nearest object; negative for an overlap.

    The objects are walls, obstacles, and other agents that are present; inf: there is none.
    """
    world = episode.world
    if (world.agents.rounding > 0.0).any():
        return _of_shapes(episode, agent)
    here = episode.position[:, agent]  # (T+1, 2)
    radius = world.agents.radius
    gap = np.full(len(here), np.inf)
    others = np.delete(np.arange(len(radius)), agent)
    if len(others):
        apart = np.linalg.norm(episode.position[:, others] - here[:, None], axis=-1)
        apart -= radius[others]
        there = analyse(episode).trajectories.has_body[others].T
        gap = np.where(there, apart, np.inf).min(axis=1)
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


def _of_shapes(episode: Episode, agent: int) -> FloatArray:
    world, clear = episode.world, np.full(len(episode.position), np.inf)
    things = things_of(world, episode.body_position)
    there = analyse(episode).trajectories.has_body
    lower_to_shapes(
        agent, episode.position, episode.heading, shapes_of(world.agents), there, things.capsules,
        things.body, things.offset, clear,
    )  # fmt: skip
    return clear


@kernel
def lower_to_shapes(
    a: int, position: FloatArray, heading: FloatArray, shape: FloatArray, there: BoolArray,
    capsules: FloatArray, body: IntArray, offset: FloatArray, clear: FloatArray,
) -> None:  # fmt: skip
    """Lower ``clear`` (T+1,) to the gaps of agent a, with the shapes (A, 3) of `shapes_of`.

    Positions and headings are (T+1, A); agent j is present in the states of ``there[j]`` (T+1,).
    """
    for k in range(len(clear)):
        x, y, angle = position[k, a, 0], position[k, a, 1], heading[k, a]
        for c in range(len(capsules)):
            x0, y0, x1, y1, r = capsules[c]
            fx, fy = x - 0.5 * (x0 + x1), y - 0.5 * (y0 + y1)
            if body[c] >= 0:
                away_x, away_y = offset[body[c], k, 0], offset[body[c], k, 1]
                if is_away(away_x, away_y):
                    continue
                fx, fy = fx - away_x, fy - away_y
            half = (0.5 * (x1 - x0), 0.5 * (y1 - y0), 0.0, 0.0)
            gap = cores_apart(fx, fy, angle, shape[a], half) - shape[a, 2] - r
            clear[k] = min(clear[k], gap)
        for j in range(position.shape[1]):
            if j == a or not there[j, k]:
                continue
            c0, s0 = cos_sin(heading[k, j])
            half = (shape[j, 0] * c0, shape[j, 0] * s0, -shape[j, 1] * s0, shape[j, 1] * c0)
            gap = cores_apart(x - position[k, j, 0], y - position[k, j, 1], angle, shape[a], half)
            clear[k] = min(clear[k], gap - shape[a, 2] - shape[j, 2])


def _to_capsules(points: FloatArray, capsules: FloatArray) -> FloatArray:
    """Return the distances (P, T) [m] of points (P, T, 2) to the rims of capsules (P, 5)."""
    start, way = capsules[:, None, 0:2], capsules[:, None, 2:4] - capsules[:, None, 0:2]
    length2 = np.maximum((way**2).sum(axis=-1), 1e-300)
    along = (((points - start) * way).sum(axis=-1) / length2).clip(0.0, 1.0)
    nearest = start + along[..., None] * way
    distance: FloatArray = np.linalg.norm(points - nearest, axis=-1) - capsules[:, 4:5]
    return distance
