"""Objects that an agent has perceived lately: the input of foresight, and of some policies.

The disc of a thick ray stops at an object: an agent or obstacle at that place counts as hit, and
so does an edge. Agents and movers are reported with their velocity (as Eq. 22 of the paper
uses it) and remembered for a while as if they kept it, because seven rays lose sight of objects
that pass between them. An agent without rays perceives all that is in sight, and remembers movers
that obstacles hide; other agents may have arrived meanwhile.
"""

import math
from dataclasses import replace

import numpy as np

from benchnav.arena import Kind
from benchnav.arrays import AnyArray, BoolArray, ByteArray, FloatArray, IntArray
from benchnav.geometry import nearest_on_segment
from benchnav.kernels import kernel, kernel_without_allocation
from benchnav.navigation import Edges, Need, Neighbours, Observation, RowTable

NEEDS = frozenset({Need.NEIGHBOURS, Need.EDGES})
MEMORY = 2.0  # [s] for which an agent or mover is remembered
SLACK = 0.05  # [m] largest distance of a ray's disc from the object that it hit
JAMMED = 2.0  # [s] without coming nearer to the goal, after which agents behind matter
BEHIND = -0.5  # cosine of the bearing beyond which an agent is behind
SAME = 0.8  # [m] within which a remembered object and a hit object are the same
MAX_OTHERS = 16  # agents and movers that an agent remembers
_X, _Y, _U, _V, _RADIUS, _KIND, _AGE = range(7)

_AGENT, _MOVER = int(Kind.AGENT), int(Kind.DYNAMIC)
_WALL, _STATIC = int(Kind.WALL), int(Kind.STATIC)


class Sightings:
    """The objects that each agent has hit with its rays; without rays, all that it has seen."""

    def __init__(self, rays: bool = True) -> None:
        self._rays = rays
        self._kept = RowTable()

    def forget(self, row: int, agents: int, dt: float) -> None:
        """Forget all objects in the world ``row``, which has decisions every ``dt`` [s]."""
        empty = np.zeros((agents, MAX_OTHERS, 7))
        empty[..., _AGE] = math.inf
        self._kept.put(row, met=empty, dt=np.full(agents, dt))

    def recall(self, observation: Observation) -> Observation:
        """Return the observation with others that are met or remembered, and edges that rays hit.

        Without rays, the others are nearest first.

        Args:
            observation: with neighbours, edges, and rays (if it is about them).
        """
        rays, near, edges = observation.rays, observation.neighbours, observation.edges
        assert near is not None  # noqa: S101 - declared by the pilot
        assert edges is not None  # noqa: S101
        indices = np.flatnonzero(observation.active)
        agents = observation.active.shape[1]
        dt = flat(self._kept.take("dt", observation.rows, agents))
        met = self._kept.take("met", observation.rows, agents)
        others = (
            flat(near.position), flat(near.velocity), flat(near.radius), flat(near.kind),
            flat(near.count),
        )  # fmt: skip
        perceived = np.ones(near.radius.shape, np.bool_)
        if self._rays:
            assert rays is not None  # noqa: S101
            ends = (
                flat(observation.position), flat(observation.heading), flat(rays.radius),
                rays.angle, flat(rays.distance), flat(rays.kind),
            )  # fmt: skip
            touched = np.zeros(edges.start.shape[:3], dtype=np.bool_)
            _hit(indices, *ends, *others, flat(perceived))
            _touch(
                indices, *ends, flat(edges.start), flat(edges.end), flat(edges.count),
                flat(touched),
            )  # fmt: skip
            edges = _chosen(edges, touched)
        _remember(indices, *others, flat(perceived), not self._rays, dt, flat(met))
        self._kept.write("met", observation.rows, met)
        neighbours = _others(met, observation.active)
        if not self._rays:
            neighbours = _nearest_first(neighbours, observation.position)
        return replace(observation, neighbours=neighbours, edges=edges)


def without_agents_behind(observation: Observation, stalled: FloatArray) -> Observation:
    """Return the observation without agents more than 120° from the heading, nearest first.

    They keep the distance themselves: in queues, an agent that avoids those behind it collides more
    often. But a jam dissolves faster if its agents avoid those behind them, so after `JAMMED` an
    agent perceives all again.

    Args:
        observation: with neighbours.
        stalled: (B, A) [s] for which agents have come no nearer to their goals.
    """
    near, heading = observation.neighbours, observation.heading[..., None]
    assert near is not None  # noqa: S101 - declared by the pilot
    away = near.position - observation.position[..., None, :]
    ahead = away[..., 0] * np.cos(heading) + away[..., 1] * np.sin(heading)
    behind = ahead < BEHIND * np.sqrt(np.sum(away * away, axis=-1))
    listed = np.arange(near.kind.shape[2]) < near.count[..., None]
    moves_on = stalled[..., None] <= JAMMED
    kept = listed & ~(moves_on & behind & (near.kind == _AGENT))
    worlds, agents, _ = np.ogrid[tuple(map(slice, kept.shape))]
    place = worlds, agents, np.argsort(~kept, axis=-1, kind="stable")
    neighbours = Neighbours(
        near.position[place], near.velocity[place], near.radius[place], near.kind[place],
        kept.sum(axis=-1),
    )  # fmt: skip
    return replace(observation, neighbours=neighbours)


def memory_for(hidden_movers: bool) -> Sightings | None:
    """Return the memory of a policy that is trained with or without hidden movers."""
    return Sightings(rays=False) if hidden_movers else None


def flat(array: AnyArray) -> AnyArray:
    """Return (B · A, …) of (B, A, …)."""
    return array.reshape(-1, *array.shape[2:])


def _others(met: FloatArray, active: BoolArray) -> Neighbours:
    """Return the remembered agents and movers, for active agents."""
    count = np.where(active, np.isfinite(met[..., _AGE]).sum(axis=-1), 0)
    return Neighbours(
        met[..., _X : _Y + 1].copy(), met[..., _U : _V + 1].copy(), met[..., _RADIUS].copy(),
        met[..., _KIND].astype(np.uint8), count,
    )  # fmt: skip


def _nearest_first(others: Neighbours, position: FloatArray) -> Neighbours:
    """Return the others by their distance from the agents at ``position`` (B, A, 2)."""
    away = np.linalg.norm(others.position - position[..., None, :], axis=-1)
    away[np.arange(away.shape[-1]) >= others.count[..., None]] = math.inf
    worlds, agents, _ = np.ogrid[tuple(map(slice, away.shape))]
    place = worlds, agents, np.argsort(away, axis=-1, kind="stable")
    return Neighbours(
        others.position[place], others.velocity[place], others.radius[place], others.kind[place],
        others.count,
    )  # fmt: skip


def _chosen(edges: Edges, which: BoolArray) -> Edges:
    """Return some of the edges, still nearest first."""
    worlds, agents, _ = np.ogrid[tuple(map(slice, which.shape))]
    place = worlds, agents, np.argsort(~which, axis=-1, kind="stable")
    return Edges(
        edges.start[place], edges.end[place], edges.before[place], edges.after[place],
        edges.start_convex[place], edges.end_convex[place], which.sum(axis=-1),
    )  # fmt: skip


@kernel_without_allocation
def _hit(
    indices: IntArray, position: FloatArray, heading: FloatArray, radius: FloatArray,
    angle: FloatArray, distance: FloatArray, ray_kind: ByteArray, other: FloatArray,
    velocity: FloatArray, other_radius: FloatArray, kind: ByteArray, others: IntArray,
    perceived: BoolArray,
) -> None:  # fmt: skip
    """Set ``perceived`` (N, K): the others at which a ray's disc stopped."""
    for i in indices:
        for j in range(others[i]):
            perceived[i, j] = False
            for r in range(len(angle)):
                if ray_kind[i, r] != kind[i, j]:
                    continue
                course = heading[i] + angle[r]
                dx = position[i, 0] + distance[i, r] * math.cos(course) - other[i, j, 0]
                dy = position[i, 1] + distance[i, r] * math.sin(course) - other[i, j, 1]
                if math.hypot(dx, dy) <= radius[i] + other_radius[i, j] + SLACK:
                    perceived[i, j] = True
                    break


@kernel
def _remember(
    indices: IntArray, other: FloatArray, velocity: FloatArray, other_radius: FloatArray,
    kind: ByteArray, others: IntArray, perceived: BoolArray, movers_only: bool, dt: FloatArray,
    met: FloatArray,
) -> None:  # fmt: skip
    """Update the memory ``met`` (N, MAX_OTHERS, 7): what is perceived now comes first.

    ``movers_only``: agents are forgotten at once.
    """
    for i in indices:
        old = met[i].copy()
        met[i, :, _AGE] = math.inf
        n = 0
        for j in range(others[i]):
            if n == MAX_OTHERS or not perceived[i, j]:
                continue
            met[i, n, _X], met[i, n, _Y] = other[i, j, 0], other[i, j, 1]
            met[i, n, _U], met[i, n, _V] = velocity[i, j, 0], velocity[i, j, 1]
            met[i, n, _RADIUS], met[i, n, _KIND] = other_radius[i, j], kind[i, j]
            met[i, n, _AGE] = 0.0
            n += 1
        fresh = n
        for m in range(MAX_OTHERS):
            age = old[m, _AGE] + dt[i]
            if n == MAX_OTHERS or age > MEMORY + 1e-9:
                continue
            if movers_only and old[m, _KIND] != _MOVER:
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


@kernel_without_allocation
def _touch(
    indices: IntArray, position: FloatArray, heading: FloatArray, radius: FloatArray,
    angle: FloatArray, distance: FloatArray, ray_kind: ByteArray, first: FloatArray,
    second: FloatArray, edges: IntArray, touched: BoolArray,
) -> None:  # fmt: skip
    """Set ``touched`` (N, E): the edges at which a ray's disc stopped."""
    for i in indices:
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
