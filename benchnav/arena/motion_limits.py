"""The limits of agents' motion beside speed and turn rate."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchnav.arrays import BoolArray, FloatArray

NO_LIMIT: dict[str, Any] = {
    "max_acceleration": math.inf, "max_deceleration": math.inf, "max_turn_acceleration": math.inf,
    "track_width": 0.0, "max_wheel_speed": math.inf, "wheelbase": 0.0,
    "max_steering_angle": math.inf, "max_steering_rate": math.inf, "reverse": False,
}  # fmt: skip
"""The columns of `MotionLimits`, each with the value that limits nothing."""
_UNSET: Any = None


@dataclass(frozen=True, eq=False, kw_only=True)
class MotionLimits:
    """Columns (A,) of limits; a column that is not given limits nothing.

    Worlds without these limits are hashed and stored without the columns.
    """

    max_acceleration: FloatArray = _UNSET  # (A,) [m/s²], inf: no limit
    max_deceleration: FloatArray = _UNSET  # (A,) [m/s²], inf: no limit
    max_turn_acceleration: FloatArray = _UNSET  # (A,) [rad/s²], inf: no limit
    track_width: FloatArray = _UNSET  # (A,) [m] of a differential drive, else 0
    max_wheel_speed: FloatArray = _UNSET  # (A,) [m/s] of a differential drive, else inf
    wheelbase: FloatArray = _UNSET  # (A,) [m] of an Ackermann body, else 0
    max_steering_angle: FloatArray = _UNSET  # (A,) [rad] of an Ackermann body, else inf
    max_steering_rate: FloatArray = _UNSET  # (A,) [rad/s] of an Ackermann body, inf: no limit
    reverse: BoolArray = _UNSET  # (A,) whether the body can drive backwards

    def __len__(self) -> int:
        raise NotImplementedError

    def __post_init__(self) -> None:
        for name, value in NO_LIMIT.items():
            if getattr(self, name) is None:
                object.__setattr__(self, name, np.full(len(self), value))

    @property
    def limited(self) -> bool:
        """Whether any column limits an agent."""
        return len(self.without_limit()) < len(NO_LIMIT)

    def without_limit(self) -> frozenset[str]:
        """Return the names of the columns that limit no agent."""
        return frozenset(
            name for name, value in NO_LIMIT.items() if (getattr(self, name) == value).all()
        )
