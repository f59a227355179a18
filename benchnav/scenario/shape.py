"""Shapes of walls and obstacles. Units: metres and radians; a shape is centred on its origin."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from benchnav.config.validation import FieldError
from benchnav.scenario.base import Coordinate, Distance, Length, Point, Spec
from benchnav.scenario.sampling.sampler import PositiveScalar, fixed, support

Axis = Literal["x", "y", "z"]


class Box(Spec):
    """A rectangle, centred at its origin."""

    type: Literal["box"]
    width: PositiveScalar = Field(description="extent along x [m]")
    depth: PositiveScalar | None = Field(None, description="extent along y [m]; default: `width`")

    @property
    def reach(self) -> float:
        """Return the largest distance [m] of any point from the origin."""
        w = support(self.width)[1]
        d = w if self.depth is None else support(self.depth)[1]
        return 0.5 * float((w * w + d * d) ** 0.5)


class Disc(Spec):
    """A disc, centred at its origin."""

    type: Literal["disc"]
    radius: PositiveScalar = Field(description="radius [m]")

    @property
    def reach(self) -> float:
        """Return the largest distance [m] of any point from the origin."""
        return support(self.radius)[1]


class Polygon(Spec):
    """A polygon that does not cross itself; corners clockwise or counter-clockwise."""

    type: Literal["polygon"]
    points: tuple[Point, ...] = Field(min_length=3, max_length=1000, description="corners [m]")

    @model_validator(mode="after")
    def _check(self) -> "Polygon":
        import shapely

        polygon = shapely.Polygon(self.points)
        if not polygon.is_valid or polygon.area <= 0:
            raise FieldError(
                ("points",), "must enclose one area without crossing or touching themselves"
            )
        return self

    @property
    def reach(self) -> float:
        """Return the largest distance [m] of any point from the origin."""
        return max(float((x * x + y * y) ** 0.5) for x, y in self.points)


class Polyline(Spec):
    """A wall along a line through points."""

    type: Literal["polyline"]
    points: tuple[Point, ...] = Field(
        min_length=2, max_length=1000, description="points [m] of the line"
    )
    thickness: Distance = Field(0.0, description="thickness [m] of the wall; 0 is allowed")

    @model_validator(mode="after")
    def _check(self) -> "Polyline":
        import shapely

        line = shapely.LineString(self.points)
        if not line.is_simple or line.is_closed or len(set(self.points)) < len(self.points):
            raise FieldError(("points",), "must be an open line that does not cross itself")
        return self

    @property
    def reach(self) -> float:
        """Return the largest distance [m] of any point from the origin."""
        far = max(float((x * x + y * y) ** 0.5) for x, y in self.points)
        return far + self.thickness  # half of the thickness, and mitred corners


class Mesh(Spec):
    """The outline of a triangle mesh within a band of heights, seen from above."""

    type: Literal["mesh"]
    file: str = Field(
        min_length=1, max_length=500, description="path, relative to the scenario file"
    )
    unit: Length | None = Field(
        None, description="metres [m] per unit of the file; default: the file's own unit"
    )
    up: Axis | None = Field(None, description="vertical axis; default: the file's own")
    scale: tuple[Length, Length, Length] = Field(
        (1.0, 1.0, 1.0), description="factors along x, y and z, after `unit`"
    )
    band: tuple[Coordinate, Coordinate] = Field(
        (0.05, 2.0), description="heights [m] at which the mesh is an obstacle: [low, high]"
    )

    @model_validator(mode="after")
    def _check(self) -> "Mesh":
        if not self.band[0] < self.band[1]:
            raise FieldError(("band",), f"must be [low, high] with low < high; got {self.band}")
        return self


class Occupancy(Spec):
    """The blocked cells of an occupancy grid map."""

    type: Literal["occupancy"]
    file: str = Field(
        min_length=1, max_length=500, description="path, relative to the scenario file"
    )
    format: Literal["movingai", "ros"] = Field(
        description="`movingai`: MovingAI grid map; `ros`: YAML file of the ROS map_server"
    )
    cell: Length | None = Field(
        None, description="side [m] of a cell; default: the file's own, or 1"
    )
    unknown_is_free: bool = Field(False, description="whether agents may enter unknown cells")


Movable = Annotated[Box | Disc | Polygon, Field(discriminator="type")]
Shape = Annotated[Box | Disc | Polygon | Polyline | Mesh | Occupancy, Field(discriminator="type")]


def shape_is_fixed(shape: "Shape") -> bool:
    """Whether every draw of the shape is the same."""
    if isinstance(shape, Box):
        return fixed(shape.width) and (shape.depth is None or fixed(shape.depth))
    return fixed(shape.radius) if isinstance(shape, Disc) else True
