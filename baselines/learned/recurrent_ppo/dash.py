"""Dashes to the goal of agents that come no nearer to it.

A goal beside the track of a mover can keep an agent away for ever: the policy drives around it, or
foresight expects that the mover turns back. An impatient agent that can be at its goal before the
horizon without a predicted contact takes the twist that is there first. Movers are predicted to
keep their velocity then.
"""

import math

import numpy as np

from benchnav.arrays import ByteArray, FloatArray, IntArray
from benchnav.envs import Bodies
from benchnav.kernels import kernel_without_allocation
from benchnav.navigation import Observation

from .foresight import BACK, HELD, HORIZON, SPEEDS, TICK, TURNS, danger_held, surroundings, within
from .sightings import flat

IMPATIENT = 8.0  # [s] without coming nearer to the goal


def dash(
    observation: Observation,
    bodies: Bodies,
    command: FloatArray,
    tolerance: FloatArray,
    hold: float,
    stalled: FloatArray,
) -> None:
    """Replace the twists ``command`` (B, A, 2) of impatient agents that can dash.

    Args:
        observation: with neighbours and edges.
        bodies: of the agents.
        command: twists [m/s, rad/s].
        tolerance: (B, A) [m] of the goal; 0 where the goal is a waypoint: no dash.
        hold: [s] largest duration of a twist; multiples of `HELD` up to it are tried.
        stalled: (B, A) [s] for which agents have come no nearer to their goals.
    """
    _dash(
        flat(command), np.flatnonzero(observation.active & (stalled > IMPATIENT)),
        round(hold / HELD), *surroundings(observation, bodies, tolerance),
    )  # fmt: skip


@kernel_without_allocation
def _dash(
    out: FloatArray, indices: IntArray, holds: int, position: FloatArray, heading: FloatArray,
    goal: FloatArray, tolerance: FloatArray, radius: FloatArray, max_speed: FloatArray,
    max_turn: FloatArray, other: FloatArray, velocity: FloatArray, other_radius: FloatArray,
    kind: ByteArray, others: IntArray, first: FloatArray, second: FloatArray, edges: IntArray,
) -> None:  # fmt: skip
    for i in indices:
        soonest = round(HORIZON / TICK) + 1
        for a in range(1, SPEEDS):
            for b in range(TURNS):
                v = max_speed[i] * a / (SPEEDS - 1)
                w = max_turn[i] * (2.0 * b / (TURNS - 1) - 1.0)
                for k in range(1, holds + 1):
                    tick = _arrival(
                        v, w, position[i], heading[i], goal[i], tolerance[i], k * HELD, soonest
                    )
                    if tick == soonest:
                        continue
                    danger = danger_held(
                        v, w, position[i], heading[i], goal[i], tolerance[i], radius[i], other[i],
                        velocity[i], other_radius[i], kind[i], others[i], first[i], second[i],
                        edges[i], k * HELD,
                    )  # fmt: skip
                    if danger <= BACK:
                        soonest = tick
                        out[i, 0], out[i, 1] = v, w


@kernel_without_allocation
def _arrival(
    v: float, w: float, position: FloatArray, heading: float, goal: FloatArray, tolerance: float,
    held: float, before: int,
) -> int:  # fmt: skip
    """Return the tick at which a held twist is at the goal; ``before`` if that is not earlier."""
    x, y, angle = position[0], position[1], heading
    for tick in range(1, before):
        turn = w if tick * TICK <= held + 1e-9 else 0.0
        middle = angle + 0.5 * turn * TICK
        x += v * TICK * math.cos(middle)
        y += v * TICK * math.sin(middle)
        angle += turn * TICK
        if within(goal[0] - x, goal[1] - y, tolerance):
            return tick
    return before
