"""An encoder of all directions: scans of static edges and of others, and the nearest others.

`SurroundEncoder` describes others as a list, nearest first, whose order changes while they pass
each other. Here the scan shows them too: each direction has its own numbers, so that what a
network learns about one place is not disturbed by what is elsewhere.
"""

import math
from typing import ClassVar

import numpy as np

from benchnav.arrays import ByteArray, FloatArray, IntArray
from benchnav.envs.encoders.encoder import Bodies, Number
from benchnav.envs.encoders.paper import SPEED
from benchnav.envs.encoders.surround import (
    DIRECTIONS,
    FADE,
    MOVER,
    RANGE,
    SurroundEncoder,
    neighbour_numbers,
)
from benchnav.kernels import kernel
from benchnav.navigation.observation import Observation

_EACH = 4  # numbers of a direction


class PanoramaEncoder(SurroundEncoder):
    """`SurroundEncoder` with the 4 nearest others, then 4 numbers for each of 24 directions."""

    name: ClassVar[str] = "panorama"
    others: ClassVar[int] = 4

    def _numbers(self) -> tuple[Number, ...]:
        scan = (number for k in range(DIRECTIONS) for number in _direction_numbers(k))
        return (*super()._numbers(), *scan)

    def _further(self, seen: Observation, bodies: Bodies) -> list[FloatArray]:
        assert seen.neighbours is not None  # noqa: S101 - declared in `needs`
        shape = seen.heading.shape
        out = np.zeros((*shape, DIRECTIONS * _EACH))
        agents = math.prod(shape)
        if agents:
            _scan_others(
                seen.position.reshape(agents, 2), seen.velocity.reshape(agents, 2),
                seen.heading.reshape(agents), bodies.radius.reshape(agents),
                *neighbour_numbers(seen.neighbours, agents), out.reshape(agents, -1),
            )  # fmt: skip
        return [out]


def _direction_numbers(k: int) -> list[Number]:
    speed = f"its velocity less the own, over {SPEED:g} m/s"
    return [
        Number(
            f"pan{k}.near", "m", 0, 1,
            f"exp(-free way of its disc to another / {FADE:g} m), {k * 360 / DIRECTIONS:g}°"
            " to the left; 0 if there is none",
        ),
        Number(f"pan{k}.v_along", "m/s", -2, 2, f"{speed}: away, along the direction"),
        Number(f"pan{k}.v_across", "m/s", -2, 2, f"{speed}: across it, to the left"),
        Number(f"pan{k}.mover", "", 0, 1, "it never yields"),
    ]  # fmt: skip


@kernel
def _scan_others(
    position: FloatArray, velocity: FloatArray, heading: FloatArray, radius: FloatArray,
    other_position: FloatArray, other_velocity: FloatArray, other_radius: FloatArray,
    kind: ByteArray, count: IntArray, out: FloatArray,
) -> None:  # fmt: skip
    """Set ``out`` (N, 4 · 24) to the numbers of the first other in each direction."""
    for i in range(len(position)):
        for k in range(DIRECTIONS):
            angle = heading[i] + 2.0 * math.pi * k / DIRECTIONS
            dx, dy = math.cos(angle), math.sin(angle)
            best, first = RANGE, -1
            for j in range(count[i]):
                x = other_position[i, j, 0] - position[i, 0]
                y = other_position[i, j, 1] - position[i, 1]
                reach = radius[i] + other_radius[i, j]
                along, across = x * dx + y * dy, x * dy - y * dx
                room = reach * reach - across * across
                if along > 0.0 and room > 0.0:
                    way = max(along - math.sqrt(room), 0.0)
                    if way < best:
                        best, first = way, j
            if first >= 0:
                u = other_velocity[i, first, 0] - velocity[i, 0]
                v = other_velocity[i, first, 1] - velocity[i, 1]
                row = out[i, _EACH * k : _EACH * (k + 1)]
                row[0] = math.exp(-best / FADE)
                row[1], row[2] = (dx * u + dy * v) / SPEED, (dx * v - dy * u) / SPEED
                row[3] = 1.0 if kind[i, first] == MOVER else 0.0
