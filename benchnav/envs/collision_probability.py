"""The probability of a collision with a mover (Eq. 22–24 of the paper), by velocity obstacles.

The agent is shrunk to a point, and the mover is grown by the agent's radius. Inside the
collision cone p = min(1, 1/t), with the time t [s] until the ray of the relative velocity
meets the grown disc; outside p = 0. For an overlap p = 1. The line of Eq. 22 is read as a
ray, so movers behind the agent do not count.
"""

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import ByteArray, FloatArray, IntArray
from benchnav.geometry.capsule import disc_time
from benchnav.kernels import kernel
from benchnav.sensors.readings import Neighbours

_DYNAMIC = int(Kind.DYNAMIC)


@kernel
def probability(x: float, y: float, vx: float, vy: float, reach: float) -> float:
    """Return p of one mover at (x, y) [m] from the agent; (vx, vy) [m/s] = v_A − v_B.

    ``reach`` [m] is the sum of the radii.
    """
    if x * x + y * y <= reach * reach:
        return 1.0
    t = disc_time(-x, -y, vx, vy, reach)
    return 1.0 if t <= 1.0 else 1.0 / t


@kernel
def _highest(
    position: FloatArray, velocity: FloatArray, radius: FloatArray, other_position: FloatArray,
    other_velocity: FloatArray, other_radius: FloatArray, kind: ByteArray, count: IntArray,
    out: FloatArray,
) -> None:  # fmt: skip
    """Set ``out`` (N,) to the highest probability over the movers among ``count`` (N,) others."""
    for i in range(len(position)):
        out[i] = 0.0
        for k in range(count[i]):
            if kind[i, k] == _DYNAMIC:
                p = probability(
                    other_position[i, k, 0] - position[i, 0],
                    other_position[i, k, 1] - position[i, 1],
                    velocity[i, 0] - other_velocity[i, k, 0],
                    velocity[i, 1] - other_velocity[i, k, 1],
                    radius[i] + other_radius[i, k],
                )
                out[i] = max(out[i], p)


def collision_probability(
    position: FloatArray, velocity: FloatArray, radius: FloatArray, seen: Neighbours
) -> FloatArray:
    """Return the highest probability (B, A) over dynamic obstacles in each observation; else 0.

    Args:
        position: (B, A, 2) [m].
        velocity: (B, A, 2) [m/s].
        radius: (B, A) [m].
        seen: the sensed neighbours; dynamic obstacles have circumscribed radii.
    """
    K = seen.position.shape[2]
    out = np.zeros(position.shape[:2])
    if out.size and K:
        _highest(
            position.reshape(-1, 2), velocity.reshape(-1, 2), radius.reshape(-1),
            seen.position.reshape(-1, K, 2), seen.velocity.reshape(-1, K, 2),
            seen.radius.reshape(-1, K), seen.kind.reshape(-1, K), seen.count.reshape(-1),
            out.reshape(-1),
        )  # fmt: skip
    return out
