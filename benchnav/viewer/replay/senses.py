"""The sensor readings of some agents of a stored episode, from its stored commands."""

from dataclasses import dataclass, replace

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import AnyArray, FloatArray, IntArray
from benchnav.envs.collision_probability import collision_probability
from benchnav.episode.episode import Episode
from benchnav.geometry.rotation import cos_sin
from benchnav.navigation.observe import deciding
from benchnav.runner.rollouts.rollout import Assignment
from benchnav.runner.rollouts.seeding import noise_key
from benchnav.sensors.noise.noisy_senses import NoisySenses
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
    places: FloatArray | None  # (T+1, n, K, 2) [m] of the neighbours with noise; None: exact
    edges: IntArray | None  # (T+1, n, E) row of `edge_table`; -1: empty
    edge_table: FloatArray  # (N, 4) [m] x, y of the start and of the end
    probability: FloatArray | None  # (T+1, n) of a collision (Eq. 24), with any sensed neighbour
    noisy: bool  # whether the noise of noisy perception is included


def sensed(
    episode: Episode, agents: IntArray, assignment: Assignment | None = None
) -> Senses | None:
    """Return what ``agents`` (n,) sensed, or None if the episode cannot be stepped again.

    The episode is simulated again, so the readings are those that the navigator had. In the
    perception track `noisy`, they have noise if the ``assignment`` of the episode is given and all
    of ``agents`` are evaluated; they are placed relative to the true pose, as seen from the body.
    """
    if not len(agents) or unfit(episode.world, episode):
        return None
    simulation = Simulation([episode.world])
    noise = _noise(episode, simulation, agents, assignment)
    twist = np.asarray(episode.twist)[None]
    needs = frozenset((RAYS, NEIGHBOURS, EDGES))
    steps = len(episode.requested)
    readings = []
    for t in range(steps + 1):
        active = deciding(simulation, agents[None])
        chosen = np.where(active, agents, -1)
        if noise is None:
            found = sense(simulation, chosen, needs)
        else:
            found = _seen_from_bodies(noise, simulation, noise.sense(active, needs), agents)
        readings.append((*found, *_motion(simulation, agents)))
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
        places=np.stack([n.position[0] for n in seen]) if noise is not None and seen else None,
        edges=rows, edge_table=table,
        probability=_probability(episode, agents, seen, position, velocity),
        noisy=noise is not None,
    )  # fmt: skip


def _noise(
    episode: Episode, simulation: Simulation, agents: IntArray, assignment: Assignment | None
) -> NoisySenses | None:
    """Return the noise that the agents met; None if there was none, or it is unknown."""
    made = assignment
    if made is None or made.noise is None or not episode.world.agents.evaluated[agents].all():
        return None
    senses, identity = NoisySenses(simulation, agents[None], made.noise), episode.identity
    key = noise_key(made.salt, made.scenario_hash, made.split, identity.seed, identity.rehearsal)
    senses.begin(np.zeros(1, np.int64), key[None])
    return senses


def _seen_from_bodies(
    noise: NoisySenses, simulation: Simulation,
    readings: tuple[Rays | None, Neighbours | None, Edges | None], agents: IntArray,
) -> tuple[Rays | None, Neighbours | None, Edges | None]:  # fmt: skip
    """Return readings in odometry frames as they lie about the true poses, in the world frame."""
    rays, neighbours, edges = readings
    error, origin = noise.pose_error[0], simulation.position[0, agents]
    turns = np.array([cos_sin(-angle) for angle in error[:, 2]])
    c, s = turns[None, :, :1], turns[None, :, 1:]

    def turned(vector: FloatArray) -> FloatArray:  # (1, n, K, 2)
        x, y = vector[..., 0], vector[..., 1]
        return np.stack([c * x - s * y, s * x + c * y], axis=-1)

    def placed(point: FloatArray) -> FloatArray:
        place: FloatArray = origin[:, None] + turned(point - (origin + error[:, :2])[:, None])
        return place

    if neighbours is not None:
        neighbours = replace(
            neighbours, position=placed(neighbours.position), velocity=turned(neighbours.velocity)
        )
    if edges is not None:
        edges = replace(edges, start=placed(edges.start), end=placed(edges.end))
    return rays, neighbours, edges


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
