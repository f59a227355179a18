"""Fixed structure: single walls, and layouts that generate many."""

from typing import Annotated, Literal

from pydantic import Field, Tag, model_validator

from benchnav.arrays import Extent
from benchnav.config.validation import FieldError
from benchnav.scenario.base import ONE_OR_MORE, Length, Spec
from benchnav.scenario.sampling.sampler import Scalar, fixed
from benchnav.scenario.shape import Mesh, Occupancy, Shape, shape_is_fixed

Place = tuple[Scalar, Scalar]  # [m]
Share = Annotated[float, Field(ge=0, le=1)]


class Wall(Spec):
    """A wall, or the same wall in several places."""

    shape: Shape = Field(description="shape of the wall")
    at: Annotated[
        Annotated[Place, Tag("a point")]
        | Annotated[tuple[Place, ...], Field(min_length=1, max_length=1000), Tag("several points")],
        ONE_OR_MORE,
    ] = Field(
        (0.0, 0.0),
        description="position of the shape's origin: [x, y], or a list of such points with one"
        " wall at each [m]",
    )
    heading: Scalar = Field(
        0.0, description="rotation [rad], counter-clockwise; not for occupancy maps"
    )

    @model_validator(mode="after")
    def _check(self) -> "Wall":
        if isinstance(self.shape, Mesh | Occupancy):
            numbers = [("at", number) for place in self.places for number in place]
            for key, number in (*numbers, ("heading", self.heading)):
                if not isinstance(number, float):
                    kind = self.shape.type
                    raise FieldError((key,), f"must be plain numbers for a shape of type {kind}")
        if isinstance(self.shape, Occupancy) and self.heading != 0.0:
            raise FieldError(("heading",), "must be 0 for an occupancy map")
        return self

    @property
    def fixed(self) -> bool:
        """Whether every draw is the same."""
        numbers = (number for place in self.places for number in place)
        return shape_is_fixed(self.shape) and all(map(fixed, (*numbers, self.heading)))

    @property
    def places(self) -> tuple[Place, ...]:
        """The places of the shape, one or several."""
        first = self.at[0]
        return self.at if isinstance(first, tuple) else (self.at,)  # type: ignore[return-value]


class Maze(Spec):
    """A random maze that fills the arena: a spanning tree over a grid of cells, plus loops."""

    type: Literal["maze"]
    columns: int = Field(ge=2, le=100, description="cells along x")
    rows: int = Field(ge=2, le=100, description="cells along y")
    thickness: Length = Field(0.2, description="thickness [m] of the walls")
    loops: Share = Field(0.0, description="fraction of the remaining inner walls that is removed")


class Rooms(Spec):
    """A grid of rooms that fills the arena; random doors connect all rooms."""

    type: Literal["rooms"]
    columns: int = Field(ge=1, le=50, description="rooms along x")
    rows: int = Field(ge=1, le=50, description="rooms along y")
    door: Length = Field(1.2, description="clear width [m] of a door")
    thickness: Length = Field(0.2, description="thickness [m] of the walls")
    extra_doors: Share = Field(
        0.2, description="fraction of the other inner walls that gets a door too"
    )


Layout = Annotated[Maze | Rooms, Field(discriminator="type")]


def layout_problem(layout: "Layout", bounds: Extent) -> str:
    """Why ``layout`` does not fit ``bounds``; "" if it does."""
    width = (bounds[2] - bounds[0]) / layout.columns
    height = (bounds[3] - bounds[1]) / layout.rows
    need = layout.thickness + (layout.door if isinstance(layout, Rooms) else 0.0)
    if min(width, height) <= need:
        return (
            f"needs cells wider than {need:g} m; {layout.columns} × {layout.rows} of them"
            f" in these bounds are {width:g} × {height:g} m"
        )
    return ""
