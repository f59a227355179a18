"""What the rays meet, and what of it stays in mind: what may be foreseen by who sees by rays.

The disc of a thick ray comes to rest on something: an agent or obstacle counts as met if it
is there, and so does an edge. Others are told with their velocity (as Eq. 22 of the paper
takes it) and remembered for a while as if they kept it, for seven rays lose from sight what
passes between them.
"""

import math
from dataclasses import replace

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import AnyArray, BoolArray, ByteArray, FloatArray, IntArray
from benchnav.geometry.capsule import nearest_on_segment
from benchnav.kernels import kernel
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.observation import Observation
from benchnav.navigation.row_table import RowTable
from benchnav.sensors.readings import Edges, Neighbours

MEMORY = 2.0  # [s] for which somebody is remembered
SLACK = 0.05  # [m] by which a ray's disc may be away from what it met
SAME = 0.8  # [m] within which somebody remembered is somebody met
MOST = 16  # others that an agent keeps in mind
_X, _Y, _U, _V, _RADIUS, _KIND, _AGE = range(7)

_WALL, _STATIC = int(Kind.WALL), int(Kind.STATIC)


class Sightings:
    """What each agent has met with its rays."""

    def __init__(self) -> None:
        self._kept = RowTable()

    def reset(self, row: int, told: Briefing) -> None:
        """Nothing was met in the world ``row`` yet."""
        nobody = np.zeros((len(told), MOST, 7))
        nobody[..., _AGE] = math.inf
        self._kept.put(row, met=nobody, dt=np.full(len(told), told.dt))

    def limit(self, seen: Observation, radius: FloatArray) -> Observation:
        """The same view, with the others and edges alone that the rays (B, A) met.

        Args:
            seen: with rays, neighbours and edges.
            radius: (B, A) [m] of the agents, and of the discs of their rays.
        """
        rays, near, edges = seen.rays, seen.neighbours, seen.edges
        assert rays is not None  # noqa: S101 - declared by the pilot
        assert near is not None  # noqa: S101
        assert edges is not None  # noqa: S101
        agents = seen.active.shape[1]
        met = self._kept.take("met", seen.rows, agents)
        touched = np.zeros(edges.start.shape[:3], dtype=np.bool_)

        def flat(array: AnyArray) -> AnyArray:
            return array.reshape(-1, *array.shape[2:])

        who = np.flatnonzero(seen.active)
        position, heading, reach = flat(seen.position), flat(seen.heading), flat(radius)
        distance, kinds = flat(rays.distance), flat(rays.kind)
        _meet(
            who, position, heading, reach, rays.angle, distance, kinds, flat(near.position),
            flat(near.velocity), flat(near.radius), flat(near.kind), flat(near.count),
            flat(self._kept.take("dt", seen.rows, agents)), flat(met),
        )  # fmt: skip
        _touch(
            who, position, heading, reach, rays.angle, distance, kinds, flat(edges.start),
            flat(edges.end), flat(edges.count), flat(touched),
        )  # fmt: skip
        self._kept.write("met", seen.rows, met)
        return replace(seen, neighbours=_others(met), edges=_chosen(edges, touched))


def _others(met: FloatArray) -> Neighbours:
    """Everybody in mind."""
    return Neighbours(
        met[..., _X : _Y + 1].copy(), met[..., _U : _V + 1].copy(), met[..., _RADIUS].copy(),
        met[..., _KIND].astype(np.uint8), np.isfinite(met[..., _AGE]).sum(axis=-1),
    )  # fmt: skip


def _chosen(edges: Edges, which: BoolArray) -> Edges:
    """Some of the edges, still nearest first."""
    order = np.argsort(~which, axis=-1, kind="stable")
    index = order[..., None]

    def moved(array: AnyArray) -> AnyArray:
        return np.take_along_axis(array, index if array.ndim == 4 else order, axis=2)

    return Edges(
        moved(edges.start), moved(edges.end), moved(edges.before), moved(edges.after),
        moved(edges.start_convex), moved(edges.end_convex), which.sum(axis=-1),
    )  # fmt: skip


@kernel
def _meet(
    who: IntArray, position: FloatArray, heading: FloatArray, radius: FloatArray,
    angle: FloatArray, distance: FloatArray, ray_kind: ByteArray, other: FloatArray,
    velocity: FloatArray, other_radius: FloatArray, kind: ByteArray, others: IntArray,
    dt: FloatArray, met: FloatArray,
) -> None:  # fmt: skip
    """Bring what is in mind, ``met`` (N, MOST, 7), up to date: who is met now comes first."""
    for i in who:
        old = met[i].copy()
        met[i, :, _AGE] = math.inf
        n = 0
        for j in range(others[i]):
            for r in range(len(angle)):
                if ray_kind[i, r] != kind[i, j] or n == MOST:
                    continue
                course = heading[i] + angle[r]
                dx = position[i, 0] + distance[i, r] * math.cos(course) - other[i, j, 0]
                dy = position[i, 1] + distance[i, r] * math.sin(course) - other[i, j, 1]
                if math.hypot(dx, dy) <= radius[i] + other_radius[i, j] + SLACK:
                    met[i, n, _X], met[i, n, _Y] = other[i, j, 0], other[i, j, 1]
                    met[i, n, _U], met[i, n, _V] = velocity[i, j, 0], velocity[i, j, 1]
                    met[i, n, _RADIUS], met[i, n, _KIND] = other_radius[i, j], kind[i, j]
                    met[i, n, _AGE] = 0.0
                    n += 1
                    break
        fresh = n
        for m in range(MOST):
            age = old[m, _AGE] + dt[i]
            if n == MOST or age > MEMORY + 1e-9:
                continue
            x, y = old[m, _X] + dt[i] * old[m, _U], old[m, _Y] + dt[i] * old[m, _V]
            known = False
            for k in range(fresh):
                away = math.hypot(met[i, k, _X] - x, met[i, k, _Y] - y)
                known |= met[i, k, _KIND] == old[m, _KIND] and away <= SAME
            if not known:
                met[i, n] = old[m]
                met[i, n, _X], met[i, n, _Y], met[i, n, _AGE] = x, y, age
                n += 1


@kernel
def _touch(
    who: IntArray, position: FloatArray, heading: FloatArray, radius: FloatArray,
    angle: FloatArray, distance: FloatArray, ray_kind: ByteArray, first: FloatArray,
    second: FloatArray, edges: IntArray, touched: BoolArray,
) -> None:  # fmt: skip
    """``touched`` (N, E): on which edges a ray's disc came to rest."""
    for i in who:
        for r in range(len(angle)):
            if ray_kind[i, r] != _WALL and ray_kind[i, r] != _STATIC:
                continue
            course = heading[i] + angle[r]
            x = position[i, 0] + distance[i, r] * math.cos(course)
            y = position[i, 1] + distance[i, r] * math.sin(course)
            for e in range(edges[i]):
                px, py = nearest_on_segment(
                    x, y, first[i, e, 0], first[i, e, 1], second[i, e, 0], second[i, e, 1]
                )
                if math.hypot(px - x, py - y) <= radius[i] + SLACK:
                    touched[i, e] = True
