"""`PanoramaEncoder`, and when the agent would meet another if it drove in each direction.

The times assume that the others keep their velocity: what a velocity obstacle says about a
command, as numbers that a policy can read (Fiorini and Shiller, Motion planning in dynamic
environments using velocity obstacles, 1998). Further times assume that movers turn back at once.
"""

import math
from typing import ClassVar

import numpy as np

from benchnav.arrays import ByteArray, FloatArray, IntArray
from benchnav.envs.encoders.encoder import Bodies, Number
from benchnav.envs.encoders.panorama import PanoramaEncoder
from benchnav.envs.encoders.surround import DIRECTIONS, MOVER, neighbour_numbers
from benchnav.geometry.capsule import disc_time
from benchnav.kernels import kernel
from benchnav.navigation.observation import Observation

SHARES = (1.0, 0.5)  # of the top speed, in each direction
_WORDS = {"full": "its top speed", "half": "half its top speed"}
SOON = 1.5  # [s] in which the number falls by the factor e
_WAYS = len(SHARES) * DIRECTIONS + 2


class OutlookEncoder(PanoramaEncoder):
    """`PanoramaEncoder`, then 100 numbers about contacts to come."""

    name: ClassVar[str] = "outlook"

    def _numbers(self) -> tuple[Number, ...]:
        kept = _ways("soon", f"exp(-time until it meets another / {SOON:g} s)")
        turned = _ways("back", f"exp(-time until it meets a mover that turns back / {SOON:g} s)")
        return (*super()._numbers(), *kept, *turned)

    def _further(self, seen: Observation, bodies: Bodies) -> list[FloatArray]:
        assert seen.neighbours is not None  # noqa: S101 - declared in `needs`
        shape = seen.heading.shape
        out = np.zeros((*shape, 2 * _WAYS))
        agents = math.prod(shape)
        if agents:
            position, velocity, radius, kind, count = neighbour_numbers(seen.neighbours, agents)
            _foresee(
                seen.position.reshape(agents, 2), seen.velocity.reshape(agents, 2),
                seen.heading.reshape(agents), bodies.radius.reshape(agents),
                bodies.max_speed.reshape(agents), position, velocity, radius, kind, count,
                out.reshape(agents, -1),
            )  # fmt: skip
        return [*super()._further(seen, bodies), out]


def _ways(name: str, soon: str) -> list[Number]:
    ways = [
        Number(f"{name}{k}.{share}", "s", 0, 1, f"{soon} at {speed}, {degrees}° to the left")
        for k, degrees in enumerate(f"{k * 360 / DIRECTIONS:g}" for k in range(DIRECTIONS))
        for share, speed in _WORDS.items()
    ]
    stay = Number(f"{name}.standing", "s", 0, 1, f"{soon} if it stands")
    keep = Number(f"{name}.as_now", "s", 0, 1, f"{soon} at its own velocity")
    return [*ways, stay, keep]


@kernel
def _foresee(
    position: FloatArray, velocity: FloatArray, heading: FloatArray, radius: FloatArray,
    top: FloatArray, other_position: FloatArray, other_velocity: FloatArray,
    other_radius: FloatArray, kind: ByteArray, count: IntArray, out: FloatArray,
) -> None:  # fmt: skip
    """Set ``out`` (N, 100) to the nearness in time of the first contact of each way to drive."""
    for i in range(len(position)):
        for k in range(_WAYS):
            u, v = velocity[i]
            if k < _WAYS - 2:
                angle = heading[i] + 2.0 * math.pi * (k // 2) / DIRECTIONS
                speed = top[i] * SHARES[k % 2]
                u, v = speed * math.cos(angle), speed * math.sin(angle)
            elif k == _WAYS - 2:
                u = v = 0.0
            kept = turned = math.inf
            for j in range(count[i]):
                x = position[i, 0] - other_position[i, j, 0]
                y = position[i, 1] - other_position[i, j, 1]
                reach = radius[i] + other_radius[i, j]
                w, z = other_velocity[i, j]
                kept = min(kept, disc_time(x, y, u - w, v - z, reach))
                if kind[i, j] == MOVER:
                    turned = min(turned, disc_time(x, y, u + w, v + z, reach))
            out[i, k] = math.exp(-kept / SOON)
            out[i, _WAYS + k] = math.exp(-turned / SOON)
