"""Regions from which points are drawn, uniformly by area."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from benchnav.arrays import Extent
from benchnav.config.validation import FieldError
from benchnav.scenario.base import Bounds, Distance, Length, Point, Spec


class Rectangle(Spec):
    """An axis-aligned rectangle."""

    type: Literal["rectangle"]
    bounds: Bounds = Field(description="edges: [xmin, ymin, xmax, ymax] [m]")

    def box(self, arena: Extent) -> Extent:
        """Return the smallest rectangle around the region."""
        return self.bounds


class DiscRegion(Spec):
    """The inside of a circle."""

    type: Literal["disc"]
    center: Point = Field(description="centre [m]")
    radius: Length = Field(description="radius [m]")

    def box(self, arena: Extent) -> Extent:
        """Return the smallest rectangle around the region."""
        (x, y), r = self.center, self.radius
        return (x - r, y - r, x + r, y + r)


class Ring(Spec):
    """The area between two circles."""

    type: Literal["ring"]
    center: Point = Field(description="centre [m]")
    inner: Distance = Field(description="radius [m] of the inner circle")
    outer: Length = Field(description="radius [m] of the outer circle")

    @model_validator(mode="after")
    def _check(self) -> "Ring":
        if not self.inner <= self.outer:
            raise FieldError(("outer",), f"must be ≥ inner ({self.inner:g}); got {self.outer:g}")
        return self

    def box(self, arena: Extent) -> Extent:
        """Return the smallest rectangle around the region."""
        (x, y), r = self.center, self.outer
        return (x - r, y - r, x + r, y + r)


class Points(Spec):
    """One of a list of points."""

    type: Literal["points"]
    points: tuple[Point, ...] = Field(
        min_length=1, max_length=5000, description="points [m] to choose from"
    )

    def box(self, arena: Extent) -> Extent:
        """Return the smallest rectangle around the region."""
        xs, ys = zip(*self.points, strict=True)
        return (min(xs), min(ys), max(xs), max(ys))


class Anywhere(Spec):
    """The whole arena, minus a margin along its bounds."""

    type: Literal["anywhere"]
    margin: Distance = Field(0.0, description="width [m] of the border that is left out")

    def box(self, arena: Extent) -> Extent:
        """Return the smallest rectangle around the region."""
        m = self.margin
        return (arena[0] + m, arena[1] + m, arena[2] - m, arena[3] - m)


Region = Annotated[Rectangle | DiscRegion | Ring | Points | Anywhere, Field(discriminator="type")]


def region_problem(region: "Region", arena: Extent) -> str:
    """Return why ``region`` does not fit the arena's bounds; "" if it does."""
    x0, y0, x1, y1 = region.box(arena)
    if x0 > x1 or y0 > y1:
        return "leaves nothing of the arena: its margin is too large"
    slack = 1e-9
    if (
        x0 < arena[0] - slack
        or y0 < arena[1] - slack
        or x1 > arena[2] + slack
        or y1 > arena[3] + slack
    ):
        spans = f"x {x0:g} to {x1:g}, y {y0:g} to {y1:g}"
        return (
            f"must lie within the bounds [{', '.join(f'{b:g}' for b in arena)}]; it spans {spans}"
        )
    return ""
