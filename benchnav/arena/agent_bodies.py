"""The bodies of agents beyond radius, speed and turn rate: shapes, limits, and when they enter."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchnav.arrays import BoolArray, FloatArray

NO_LIMITS: dict[str, Any] = {
    "max_acceleration": math.inf, "max_deceleration": math.inf, "max_turn_acceleration": math.inf,
    "track_width": 0.0, "max_wheel_speed": math.inf, "wheelbase": 0.0,
    "max_steering_angle": math.inf, "max_steering_rate": math.inf, "reverse": False,
}  # fmt: skip
DISC: dict[str, Any] = {"half_length": 0.0, "half_width": 0.0, "rounding": 0.0}
AT_START: dict[str, Any] = {"enters": 0.0}
PLAIN_BODY = NO_LIMITS | DISC | AT_START
"""The columns of `AgentBodies`, each with its value for a disc without limits, there from t = 0."""
_UNSET: Any = None


@dataclass(frozen=True, eq=False, kw_only=True)
class AgentBodies:
    """Columns (A,) of limits, shapes and times; one that is not given is that of `PLAIN_BODY`.

    A column with only such values is neither hashed nor stored.
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
    # the footprint: a rectangle with rounded corners; all three are 0 for a disc of `radius`
    half_length: FloatArray = _UNSET  # (A,) [m] half the extent along the heading
    half_width: FloatArray = _UNSET  # (A,) [m] half the extent across the heading
    rounding: FloatArray = _UNSET  # (A,) [m] radius of the corners; of a capsule, the half width
    enters: FloatArray = _UNSET  # (A,) [s] it enters the arena then, or once its start is free

    def __len__(self) -> int:
        raise NotImplementedError

    def __post_init__(self) -> None:
        for name, value in PLAIN_BODY.items():
            if getattr(self, name) is None:
                object.__setattr__(self, name, np.full(len(self), value))

    @property
    def inner_radius(self) -> FloatArray:
        """(A,) [m] Radius of the circle within the footprint; of a disc, its radius."""
        radius: FloatArray = self.radius  # type: ignore[attr-defined]
        inner: FloatArray = np.where(
            self.rounding > 0.0, np.minimum(self.half_length, self.half_width), radius
        )
        return inner

    @property
    def limited(self) -> bool:
        """Whether any column limits an agent's motion."""
        return not self.left_out().issuperset(NO_LIMITS)

    def left_out(self) -> frozenset[str]:
        """Return the names of the columns that are those of plain bodies for all agents."""
        return frozenset(
            name for name, value in PLAIN_BODY.items() if (getattr(self, name) == value).all()
        )
