"""`PanoramaEncoder`, and when the agent would meet another if it drove in each direction.

The times assume that the others keep their velocity: what a velocity obstacle says about a
command, as numbers that a policy can read (Fiorini and Shiller, Motion planning in dynamic
environments using velocity obstacles, 1998).
"""

import math
from typing import ClassVar

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.envs.encoders.encoder import Bodies, Number
from benchnav.envs.encoders.panorama import PanoramaEncoder
from benchnav.envs.encoders.surround import DIRECTIONS, neighbour_numbers
from benchnav.geometry.capsule import disc_time
from benchnav.kernels import kernel
from benchnav.navigation.observation import Observation

SHARES = (1.0, 0.5)  # of the top speed, in each direction
_WORDS = {"full": "its top speed", "half": "half its top speed"}
SOON = 1.5  # [s] in which the number falls by the factor e
_SIZE = len(SHARES) * DIRECTIONS + 2


class OutlookEncoder(PanoramaEncoder):
    """`PanoramaEncoder`, then 50 numbers about contacts to come."""

    name: ClassVar[str] = "outlook"

    def _numbers(self) -> tuple[Number, ...]:
        soon = f"exp(-time until it meets another / {SOON:g} s)"
        ways = [
            Number(
                f"soon{k}.{name}", "s", 0, 1,
                f"{soon} at {speed}, {k * 360 / DIRECTIONS:g}° to the left",
            )
            for k in range(DIRECTIONS)
            for name, speed in _WORDS.items()
        ]  # fmt: skip
        stay = Number("soon.standing", "s", 0, 1, f"{soon} if it stands")
        keep = Number("soon.as_now", "s", 0, 1, f"{soon} at its own velocity")
        return (*super()._numbers(), *ways, stay, keep)

    def _further(self, seen: Observation, bodies: Bodies) -> list[FloatArray]:
        assert seen.neighbours is not None  # noqa: S101 - declared in `needs`
        shape = seen.heading.shape
        out = np.zeros((*shape, _SIZE))
        agents = math.prod(shape)
        if agents:
            position, velocity, radius, _, count = neighbour_numbers(seen.neighbours, agents)
            _foresee(
                seen.position.reshape(agents, 2), seen.velocity.reshape(agents, 2),
                seen.heading.reshape(agents), bodies.radius.reshape(agents),
                bodies.max_speed.reshape(agents), position, velocity, radius, count,
                out.reshape(agents, -1),
            )  # fmt: skip
        return [*super()._further(seen, bodies), out]


@kernel
def _foresee(
    position: FloatArray, velocity: FloatArray, heading: FloatArray, radius: FloatArray,
    top: FloatArray, other_position: FloatArray, other_velocity: FloatArray,
    other_radius: FloatArray, count: IntArray, out: FloatArray,
) -> None:  # fmt: skip
    """Set ``out`` (N, 50) to the nearness in time of the first contact of each way to drive."""
    for i in range(len(position)):
        for k in range(_SIZE):
            u, v = velocity[i]
            if k < 2 * DIRECTIONS:
                angle = heading[i] + 2.0 * math.pi * (k // 2) / DIRECTIONS
                speed = top[i] * SHARES[k % 2]
                u, v = speed * math.cos(angle), speed * math.sin(angle)
            elif k == 2 * DIRECTIONS:
                u = v = 0.0
            first = math.inf
            for j in range(count[i]):
                x = position[i, 0] - other_position[i, j, 0]
                y = position[i, 1] - other_position[i, j, 1]
                reach = radius[i] + other_radius[i, j]
                w, z = u - other_velocity[i, j, 0], v - other_velocity[i, j, 1]
                first = min(first, disc_time(x, y, w, z, reach))
            out[i, k] = math.exp(-first / SOON)
