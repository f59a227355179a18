"""Encounters of evaluated agents with people: dimensionless numbers and approaches, kernels.

People are those of `World.people`. As PedPy does, the numbers take places in frames, and
velocities from the frame before to the frame after; at the ends of a track, from one frame.
"""

import math
from typing import NamedTuple

import numpy as np

from benchnav.arena.world import World
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.geometry.capsule import disc_time
from benchnav.kernels import kernel_without_allocation
from benchnav.metrics.quantities.density import frame_times
from benchnav.metrics.quantities.trajectory import (
    INSTANT,
    Trajectories,
    positions_at,
    present_at,
)
from benchnav.world.bodies import is_away

RATE = 5.0  # [Hz] of frames
SOCIAL = 0.8  # [m] r_soc of Cordes et al. 2024
NARROWEST = 0.2  # [m] l_min of Cordes et al. 2024
NEIGHBOURS = 3.0 * SOCIAL  # [m] between centres
CLOSEST = 0.26  # [m] nearer centres count as this near, because the number diverges at l_min
PERSONAL = 1.2  # [m] Hall 1966: upper limit of personal distance, rim to rim
REACTION = 3.0  # [s] tau_0 of Cordes et al. 2024
SOONEST = 0.3  # [s] earlier collisions count as this early, because the number diverges at 0


class Tracks(NamedTuple):
    """Discs in frames."""

    place: FloatArray  # (N, F, 2) [m]
    velocity: FloatArray  # (N, F, 2) [m/s]
    there: BoolArray  # (N, F) they have a body, or are on their way
    radius: FloatArray  # (N,) [m]


class Approaches(NamedTuple):
    """How evaluated agents meet people in each frame of their attempt; 0 after it."""

    frames: IntArray  # (N,) of the attempt
    intrusion: FloatArray  # (N, F) intrusion number towards people
    avoidance: FloatArray  # (N, F) avoidance number towards people
    approach: FloatArray  # (N, F) in [0, 1], approach in personal space


def approaches_of(
    world: World, trajectories: Trajectories, body_position: FloatArray
) -> Approaches:
    """Return how the evaluated agents meet people, with bodies at ``body_position`` (T+1, M, 2)."""
    t, evaluated = trajectories, np.flatnonzero(world.agents.evaluated)
    agents, bodies = world.people
    times = frame_times(t, RATE)
    place, radius = positions_at(t, times), world.agents.radius
    walks = times <= t.end[evaluated, None] + INSTANT
    own = tracks(place[evaluated], walks, radius[evaluated])
    body_place = np.empty((len(bodies), len(times), 2))
    there = np.empty((len(bodies), len(times)), np.bool_)
    write_bodies(body_position, bodies, t.dt, times, body_place, there)
    people = tracks(
        np.concatenate([place[agents], body_place]),
        np.concatenate([present_at(t, times)[agents], there]),
        np.concatenate([radius[agents], [world.bodies[m].solid.radius for m in bodies]]),
    )
    return approaches(own, people, world.agents.preferred_speed[evaluated])


def approaches(agents: Tracks, people: Tracks, preferred: FloatArray) -> Approaches:
    """Return how agents meet people; ``preferred`` (N,) [m/s] is the speed of a full approach."""
    found = Approaches(agents.there.sum(axis=1), *np.zeros((3, *agents.there.shape)))
    meet_people(*agents, preferred, *people, *found[1:])
    return found


def tracks(place: FloatArray, there: BoolArray, radius: FloatArray) -> Tracks:
    """Return tracks of discs at ``place`` (N, F, 2) [m], with their velocities."""
    velocity = np.zeros_like(place)
    write_velocities(place, there, RATE, velocity)
    return Tracks(place, velocity, there, np.asarray(radius, np.float64))


@kernel_without_allocation
def write_bodies(
    position: FloatArray, bodies: IntArray, dt: float, times: FloatArray, place: FloatArray,
    there: BoolArray,
) -> None:  # fmt: skip
    """Write places (P, F, 2) [m] and presence (P, F) at ``times`` (F,) [s], linear between states.

    A body that vanishes within a step stands until then.
    """
    for f in range(len(times)):
        k = min(int(times[f] / dt + 1e-9), len(position) - 1)
        after = min(k + 1, len(position) - 1)
        share = max(times[f] / dt - k, 0.0)
        for p in range(len(bodies)):
            x, y = position[k, bodies[p], 0], position[k, bodies[p], 1]
            u, v = position[after, bodies[p], 0], position[after, bodies[p], 1]
            there[p, f] = not is_away(x, y)
            if is_away(u, v):
                u, v = x, y
            place[p, f, 0], place[p, f, 1] = x + (u - x) * share, y + (v - y) * share


@kernel_without_allocation
def write_velocities(
    place: FloatArray, there: BoolArray, rate: float, velocity: FloatArray
) -> None:
    """Write velocities (N, F, 2) [m/s]: central differences, one-sided at the ends of a track."""
    for n in range(len(place)):
        for f in range(place.shape[1]):
            if not there[n, f]:
                continue
            before = f - 1 if f > 0 and there[n, f - 1] else f
            after = f + 1 if f + 1 < place.shape[1] and there[n, f + 1] else f
            if after > before:
                each = rate / (after - before)
                velocity[n, f, 0] = (place[n, after, 0] - place[n, before, 0]) * each
                velocity[n, f, 1] = (place[n, after, 1] - place[n, before, 1]) * each


@kernel_without_allocation
def meet_people(
    place: FloatArray, velocity: FloatArray, walks: BoolArray, radius: FloatArray,
    preferred: FloatArray, people: FloatArray, motion: FloatArray, there: BoolArray,
    size: FloatArray, intrusion: FloatArray, avoidance: FloatArray, approach: FloatArray,
) -> None:  # fmt: skip
    """Raise the three results (N, F) for every agent, person and frame."""
    for a in range(len(place)):
        for p in range(len(people)):
            reach = radius[a] + size[p]
            personal = reach + PERSONAL
            for f in range(place.shape[1]):
                if not (walks[a, f] and there[p, f]):
                    continue
                fx, fy = place[a, f, 0] - people[p, f, 0], place[a, f, 1] - people[p, f, 1]
                vx, vy = velocity[a, f, 0], velocity[a, f, 1]
                wx, wy = vx - motion[p, f, 0], vy - motion[p, f, 1]
                apart2 = fx * fx + fy * fy
                if fx * wx + fy * wy < 0.0:
                    time = disc_time(fx, fy, wx, wy, reach)
                    avoidance[a, f] = max(avoidance[a, f], REACTION / max(time, SOONEST))
                if apart2 <= NEIGHBOURS * NEIGHBOURS:
                    apart = max(math.sqrt(apart2), CLOSEST)
                    part = (SOCIAL - NARROWEST) / (apart - NARROWEST)
                    intrusion[a, f] += part * part
                towards = -(fx * vx + fy * vy)
                if apart2 < personal * personal and towards > 0.0:
                    top = preferred[a] * math.sqrt(apart2)
                    weight = towards / top if towards < top else 1.0
                    approach[a, f] = max(approach[a, f], weight)
