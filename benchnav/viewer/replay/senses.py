"""The sensor readings of some agents of a stored episode, from its stored commands."""

from dataclasses import dataclass

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import AnyArray, FloatArray, IntArray
from benchnav.envs.collision_probability import collision_probability
from benchnav.episode.episode import Episode
from benchnav.navigation.observe import deciding
from benchnav.sensors.readings import Edges, Neighbours, Rays
from benchnav.sensors.sense import EDGES, NEIGHBOURS, RAYS, ray_angles, sense
from benchnav.verify.resimulation import unfit
from benchnav.world.simulation import Simulation

NONE = -1  # in an index: an empty slot


@dataclass(frozen=True, eq=False)
class Senses:
    """The readings of n agents at the times 0..T; None for a sensor that they do not have."""

    agents: IntArray  # (n,)
    angle: FloatArray  # (R,) [rad] of the rays from the heading
    distance: FloatArray | None  # (T+1, n, R) [m]
    kind: AnyArray | None  # (T+1, n, R) of Kind
    neighbours: IntArray | None  # (T+1, n, K) agent index, or A + body index; -1: empty
    edges: IntArray | None  # (T+1, n, E) row of `edge_table`; -1: empty
    edge_table: FloatArray  # (N, 4) [m] x, y of the start and of the end
    probability: FloatArray | None  # (T+1, n) of a collision (Eq. 24), with any sensed neighbour


def sensed(episode: Episode, agents: IntArray) -> Senses | None:
    """Return what ``agents`` (n,) sensed, or None if the episode cannot be stepped again.

    The episode is simulated again, so the readings are those that the navigator had, without the
    noise of noisy perception.
    """
    if not len(agents) or unfit(episode.world, episode):
        return None
    simulation = Simulation([episode.world])
    twist = np.asarray(episode.twist)[None]
    needs = frozenset((RAYS, NEIGHBOURS, EDGES))
    steps = len(episode.requested)
    readings = []
    for t in range(steps + 1):
        active = deciding(simulation, agents[None])
        chosen = np.where(active, agents, -1)
        readings.append((*sense(simulation, chosen, needs), *_motion(simulation, agents)))
        if t < steps:
            simulation.step(episode.requested[t][None], twist)
    rays, neighbours, edges, position, velocity = zip(*readings, strict=True)
    sensing = episode.world.sensing
    distance, kind = _rays([r for r in rays if r is not None])
    table, rows = _edges([e for e in edges if e is not None])
    seen = [n for n in neighbours if n is not None]
    return Senses(
        agents=agents,
        angle=ray_angles(sensing.rays) if sensing.rays is not None else np.zeros(0),
        distance=distance, kind=kind,
        neighbours=_neighbours(episode, seen),
        edges=rows, edge_table=table,
        probability=_probability(episode, agents, seen, position, velocity),
    )  # fmt: skip


def _motion(simulation: Simulation, agents: IntArray) -> tuple[FloatArray, FloatArray]:
    return simulation.position[:, agents].copy(), simulation.velocity[:, agents].copy()


def _rays(readings: list[Rays]) -> tuple[FloatArray | None, AnyArray | None]:
    if not readings:
        return None, None
    return np.stack([r.distance[0] for r in readings]), np.stack([r.kind[0] for r in readings])


def _neighbours(episode: Episode, readings: list[Neighbours]) -> IntArray | None:
    """Return which agent or body each reading is: the one whose place is nearest to it."""
    if not readings:
        return None
    agents = len(episode.world.agents)
    places = np.concatenate([episode.position, episode.body_position], axis=1)
    out = np.full((len(readings), *readings[0].kind.shape[1:]), NONE)
    for t, reading in enumerate(readings):
        apart = np.linalg.norm(reading.position[0][:, :, None] - places[t][None, None], axis=-1)
        is_body = np.arange(apart.shape[-1]) >= agents
        wrong = (reading.kind[0] == int(Kind.DYNAMIC))[..., None] != is_body
        nearest = np.where(wrong, np.inf, apart).argmin(axis=-1)
        filled = np.arange(apart.shape[1]) < reading.count[0][:, None]
        out[t] = np.where(filled, nearest, NONE)
    return out


def _edges(readings: list[Edges]) -> tuple[FloatArray, IntArray | None]:
    """Return the distinct edges (N, 4) [m], and the row of each reading."""
    if not readings:
        return np.zeros((0, 4)), None
    ends = np.stack([np.concatenate([e.start[0], e.end[0]], axis=-1) for e in readings])
    count = np.stack([e.count[0] for e in readings])
    filled = np.arange(ends.shape[2]) < count[..., None]
    rows = np.full(filled.shape, NONE)
    table, index = np.unique(ends[filled].round(3), axis=0, return_inverse=True)
    rows[filled] = index.ravel()
    return table, rows


def _probability(
    episode: Episode, agents: IntArray, readings: list[Neighbours],
    position: tuple[FloatArray, ...], velocity: tuple[FloatArray, ...],
) -> FloatArray | None:  # fmt: skip
    """Return Eq. 24 (T+1, n) over all sensed neighbours, which are agents and movers alike."""
    if not readings:
        return None

    def all_times(name: str) -> AnyArray:
        return np.concatenate([getattr(reading, name) for reading in readings])

    kind = np.full_like(all_times("kind"), int(Kind.DYNAMIC))
    seen = Neighbours(
        all_times("position"), all_times("velocity"), all_times("radius"), kind,
        all_times("count"),
    )  # fmt: skip
    radius = np.broadcast_to(episode.world.agents.radius[agents], kind.shape[:2])
    return collision_probability(
        np.concatenate(position), np.concatenate(velocity), np.ascontiguousarray(radius), seen
    )
