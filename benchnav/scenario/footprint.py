"""Footprints of a team's bodies: their shapes in the plane, along the heading."""

import math
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from benchnav.config.document import shown
from benchnav.config.validation import FieldError
from benchnav.scenario.base import Spec, with_tuples
from benchnav.scenario.sampling.sampler import PositiveScalar, support

Range = tuple[float, float]


class DiscFootprint(Spec):
    """A disc, equal to the key `radius` of the team."""

    type: Literal["disc"]
    radius: PositiveScalar = Field(description="radius [m]")

    @property
    def outer_radius(self) -> Range:
        """Return the least and the largest radius [m] of the circumscribed circle."""
        return support(self.radius)


class Capsule(Spec):
    """A rectangle with half circles at its front and its back."""

    type: Literal["capsule"]
    length: PositiveScalar = Field(description="extent [m] along the heading, at least `width`")
    width: PositiveScalar = Field(description="extent [m] across the heading")

    @property
    def outer_radius(self) -> Range:
        """Return the least and the largest radius [m] of the circumscribed circle."""
        low, high = support(self.length)
        return 0.5 * low, 0.5 * high

    @model_validator(mode="after")
    def _check(self) -> "Capsule":
        if support(self.length)[0] < support(self.width)[1]:
            raise FieldError(
                ("length",),
                f"must be ≥ width ({support(self.width)[1]:g}); got {support(self.length)[0]:g}."
                " Use `type: rounded-box` for a body that is wider than long",
            )
        return self


class RoundedBox(Spec):
    """A rectangle with rounded corners."""

    type: Literal["rounded-box"]
    length: PositiveScalar = Field(description="extent [m] along the heading")
    width: PositiveScalar = Field(description="extent [m] across the heading")
    corner_radius: PositiveScalar = Field(
        description="radius [m] of the corners, at most half of `length` and of `width`"
    )

    @property
    def outer_radius(self) -> Range:
        """Return the least and the largest radius [m] of the circumscribed circle."""
        (low_l, high_l), (low_w, high_w) = support(self.length), support(self.width)
        low_c, high_c = support(self.corner_radius)
        return _circumscribed(low_l, low_w, high_c), _circumscribed(high_l, high_w, low_c)

    @model_validator(mode="after")
    def _check(self) -> "RoundedBox":
        for name in ("length", "width"):
            least, corner = support(getattr(self, name))[0], support(self.corner_radius)[1]
            if corner > 0.5 * least:
                raise FieldError(
                    ("corner_radius",),
                    f"must be ≤ half of {name} ({0.5 * least:g}); got {corner:g}",
                )
        return self


def _circumscribed(length: float, width: float, corner: float) -> float:
    x, y = 0.5 * length - corner, 0.5 * width - corner
    return math.sqrt(x * x + y * y) + corner


def _mapping(value: Any) -> Any:
    if not isinstance(value, dict | Spec | None):
        raise ValueError(
            "must be a mapping such as {type: capsule, length: 0.8, width: 0.4};"
            f" got {shown(value)}"
        )
    return with_tuples(value)


_Any = Annotated[DiscFootprint | Capsule | RoundedBox, Field(discriminator="type")]
Footprint = Annotated[_Any, BeforeValidator(_mapping, json_schema_input_type=_Any)]
