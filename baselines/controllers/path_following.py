"""Pure pursuit: straight to the guide's target (Coulter 1992), without avoidance."""

import math
from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from benchnav.arena import Dynamics
from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.geometry import cos_sin
from benchnav.kernels import kernel
from benchnav.navigation import Briefing, Controller, Guide, Observation, PluginConfig, RowTable

from ..common.approach import approach
from ..common.car import WIDEST, car_direction
from ..common.motion_limits import BRAKE, KIND, STEP, has_limits, limits_of, stopping_speed

_CAR = float(Dynamics.ACKERMANN)


class PathFollowing(Controller):
    """Drives along its path at preferred speed, slower only to stop at its end.

    A body with a limit of deceleration drives no faster than it can stop at its target, which lies
    at the next corner. A car that cannot reach its target on one curve leaves it behind
    first, backwards if it can.
    """

    cut: ClassVar[float] = 0.03  # it does not sense the corners that it cuts

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._table = RowTable()

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        for row, briefing in zip(rows, briefings, strict=True):
            step = np.full(len(briefing), briefing.dt)
            limits = limits_of(briefing)
            self._table.put(
                int(row), speed=briefing.preferred_speed, dt=step, limits=limits,
                limited=has_limits(limits),
            )  # fmt: skip

    def steer(self, observation: Observation, guide: Guide) -> FloatArray:
        rows, agents = observation.rows, observation.active.shape[1]
        speed, dt, limits, limited = (
            self._table.take(name, rows, agents) for name in ("speed", "dt", "limits", "limited")
        )
        velocity = approach(observation.position, guide.target, speed, dt)
        limited = limited & observation.active
        if limited.any():
            _approach_within_limits(
                limited, observation.position, observation.heading, observation.velocity,
                guide.target, speed, limits, velocity,
            )  # fmt: skip
        return velocity


@kernel
def _approach_within_limits(
    limited: BoolArray, position: FloatArray, heading: FloatArray, moving: FloatArray,
    target: FloatArray, speed: FloatArray, limits: FloatArray, velocity: FloatArray,
) -> None:  # fmt: skip
    """Write velocities (B, A, 2) [m/s] of ``limited`` bodies from which they stop at the target.

    Args:
        limited: (B, A) bodies whose velocities are written.
        position: (B, A, 2) [m].
        heading: (B, A) [rad].
        moving: (B, A, 2) [m/s] velocity.
        target: (B, A, 2) [m].
        speed: (B, A) [m/s] preferred.
        limits: (B, A, 13) see `baselines.common.motion_limits`.
        velocity: (B, A, 2); the other rows are unchanged.
    """
    for b in range(limited.shape[0]):
        for a in range(limited.shape[1]):
            if not limited[b, a]:
                continue
            body, x, y = limits[b, a], position[b, a, 0], position[b, a, 1]
            dx, dy = target[b, a, 0] - x, target[b, a, 1] - y
            distance = math.sqrt(dx * dx + dy * dy)
            length = min(speed[b, a], stopping_speed(distance, body[BRAKE], body[STEP]))
            if body[KIND] == _CAR:
                c, s = cos_sin(heading[b, a])
                backwards, direction = car_direction(
                    body, x, y, heading[b, a], c * moving[b, a, 0] + s * moving[b, a, 1],
                    target[b, a, 0], target[b, a, 1], WIDEST,
                )  # fmt: skip
                if backwards:  # away from the target
                    length = speed[b, a]
                c, s = cos_sin(direction)
                velocity[b, a, 0], velocity[b, a, 1] = length * c, length * s
            else:
                scale = length / distance if distance > 0.0 else 0.0
                velocity[b, a, 0], velocity[b, a, 1] = scale * dx, scale * dy
