"""Fixed structure: single walls, and layouts that generate many."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from benchnav.scenario.base import Length, Spec
from benchnav.scenario.sampler import Scalar, fixed
from benchnav.scenario.shape import Mesh, Occupancy, Shape, shape_is_fixed
from benchnav.scenario.validation import FieldError

Share = Annotated[float, Field(ge=0, le=1)]


class Wall(Spec):
    """One piece of fixed structure."""

    shape: Shape
    at: tuple[Scalar, Scalar] = Field((0.0, 0.0), description="where the shape's origin lies [m]")
    heading: Scalar = Field(0.0, description="[rad] counter-clockwise; occupancy maps take none")

    @model_validator(mode="after")
    def _check(self) -> "Wall":
        if isinstance(self.shape, Mesh | Occupancy):
            for key, number in (("at", self.at[0]), ("at", self.at[1]), ("heading", self.heading)):
                if not isinstance(number, float):
                    kind = self.shape.type
                    raise FieldError((key,), f"must be plain numbers for a shape of type {kind}")
        if isinstance(self.shape, Occupancy) and self.heading != 0.0:
            raise FieldError(("heading",), "must be 0 for an occupancy map")
        return self

    @property
    def fixed(self) -> bool:
        """True where every draw is the same."""
        return shape_is_fixed(self.shape) and all(map(fixed, (*self.at, self.heading)))


class Maze(Spec):
    """A random maze that fills the arena: a spanning tree of a grid of cells, plus some loops."""

    type: Literal["maze"]
    columns: int = Field(ge=2, le=100)
    rows: int = Field(ge=2, le=100)
    thickness: Length = Field(0.2, description="of the walls [m]")
    loops: Share = Field(0.0, description="share of the tree's walls that are taken away")


class Rooms(Spec):
    """A grid of rooms that fills the arena; random doors join them all."""

    type: Literal["rooms"]
    columns: int = Field(ge=1, le=50)
    rows: int = Field(ge=1, le=50)
    door: Length = Field(1.2, description="clear width [m]")
    thickness: Length = Field(0.2, description="of the walls [m]")
    extra_doors: Share = Field(0.2, description="share of the doorless walls that get a door too")


Layout = Annotated[Maze | Rooms, Field(discriminator="type")]


def layout_problem(layout: "Layout", bounds: tuple[float, float, float, float]) -> str:
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
