"""Dynamics of a team's bodies: the motions that a body can make, and their limits."""

import math
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    SerializerFunctionWrapHandler,
    model_serializer,
)

from benchnav.config.document import shown
from benchnav.scenario.base import Spec, with_tuples
from benchnav.scenario.sampling.sampler import PositiveScalar, Scalar, support


def _below_a_right_angle(angle: Scalar) -> Scalar:
    low, high = support(angle)
    if low <= 0.0 or high >= 0.5 * math.pi:
        text = f"{high:g}" if low == high else f"a range from {low:g} to {high:g}"
        raise ValueError(f"must be > 0 and < 1.571 rad, a right angle; got {text}")
    return angle


SteeringAngle = Annotated[Scalar, AfterValidator(_below_a_right_angle)]


class _Dynamics(Spec):
    """Dynamics whose further keys have their defaults are written as their type alone.

    This is their form in version 0.1.0, so that hashes stay equal.
    """

    @model_serializer(mode="wrap")
    def _short(self, serialize: SerializerFunctionWrapHandler) -> Any:
        fields = serialize(self)
        defaults = {name: field.default for name, field in type(self).model_fields.items()}
        return fields["type"] if fields == {**defaults, "type": fields["type"]} else fields


class Holonomic(_Dynamics):
    """The body moves in any direction at once."""

    type: Literal["holonomic"]


class Unicycle(_Dynamics):
    """The body moves along its heading and turns, also on the spot."""

    type: Literal["unicycle"]
    reverse: bool = Field(False, description="whether the body can drive backwards")


class DifferentialDrive(_Dynamics):
    """A unicycle with two driven wheels, whose speeds are limited."""

    type: Literal["differential-drive"]
    track_width: PositiveScalar = Field(description="distance [m] between the two wheels")
    max_wheel_speed: PositiveScalar = Field(
        description="largest speed [m/s] of a wheel along the ground; commands that need more are"
        " scaled down on the same curve"
    )
    reverse: bool = Field(False, description="whether the body can drive backwards")


class Ackermann(_Dynamics):
    """A car: it steers its front wheels, and cannot turn on the spot.

    The centre of the body is the middle of the rear axle.
    """

    type: Literal["ackermann"]
    wheelbase: PositiveScalar = Field(description="distance [m] between the front and rear axles")
    max_steering_angle: SteeringAngle = Field(
        description="largest angle [rad] between the front wheels and the heading, below π/2"
    )
    max_steering_rate: PositiveScalar | None = Field(
        None, description="largest rate [rad/s] of the steering angle; default: no limit"
    )
    reverse: bool = Field(False, description="whether the body can drive backwards")


def _named(value: Any) -> Any:
    if not isinstance(value, str | dict | _Dynamics):
        raise ValueError(
            f"must be the name of a type, or a mapping with `type`; got {shown(value)}"
        )
    return {"type": value} if isinstance(value, str) else with_tuples(value)


_Mapping = Annotated[
    Holonomic | Unicycle | DifferentialDrive | Ackermann, Field(discriminator="type")
]
DynamicsSpec = Annotated[
    _Mapping,
    BeforeValidator(_named, json_schema_input_type=Literal["holonomic", "unicycle"] | _Mapping),
]
"""Dynamics as a mapping with ``type``, or as the type's name where it needs no further key."""
