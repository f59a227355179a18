"""The common base of all parts of a scenario: strictness, numbers with bounds."""

from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, Discriminator, Field, Tag

from benchnav.arrays import Extent


class Spec(BaseModel):
    """Frozen; unknown keys, NaN and infinities are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


def with_tuples(value: Any) -> Any:
    """Return plain data with tuples in place of lists.

    A `BeforeValidator` receives and returns Python data, also of a file; pydantic then demands
    tuples where it would accept the lists of JSON.
    """
    if isinstance(value, dict):
        return {key: with_tuples(part) for key, part in value.items()}
    return tuple(map(with_tuples, value)) if isinstance(value, list) else value


FAR = 1e5  # [m] largest distance of a coordinate from the origin


def _ordered(box: Extent) -> Extent:
    if not (box[0] < box[2] and box[1] < box[3]):
        raise ValueError(
            "must be [xmin, ymin, xmax, ymax] with xmin < xmax and ymin < ymax;"
            f" got [{', '.join(f'{v:g}' for v in box)}]"
        )
    return box


Coordinate = Annotated[float, Field(ge=-FAR, le=FAR)]
Point = tuple[Coordinate, Coordinate]
Length = Annotated[float, Field(gt=0, le=FAR)]
Distance = Annotated[float, Field(ge=0, le=FAR)]
Bounds = Annotated[
    tuple[Coordinate, Coordinate, Coordinate, Coordinate], AfterValidator(_ordered)
]  # xmin, ymin, xmax, ymax [m]
NAME_PATTERN = r"^[a-z0-9]+([_-][a-z0-9]+)*(/[a-z0-9]+([_-][a-z0-9]+)*)*$"  # family/name
MAX_NAME = 100  # characters of a scenario's name
Name = Annotated[str, Field(pattern=r"^[a-z0-9]+([_-][a-z0-9]+)*$", max_length=60)]


def _place_tag(value: Any) -> str:
    """Return the union tag of a place: a list whose first entry is a list holds points."""
    several = isinstance(value, list | tuple) and (not value or isinstance(value[0], list | tuple))
    return "several points" if several else "a point"


ONE_OR_MORE = Discriminator(_place_tag)
"""Tags of a union of a point and a list of points: ``a point`` and ``several points``."""
Places = Annotated[
    Annotated[Point, Tag("a point")]
    | Annotated[tuple[Point, ...], Field(min_length=1, max_length=1000), Tag("several points")],
    ONE_OR_MORE,
]
"""[x, y], or a list of such points [m]."""


def listed(places: Places | None) -> tuple[Point, ...]:
    """Return the points of one place or several; none for None."""
    if places is None:
        return ()
    return places if isinstance(places[0], tuple) else (places,)


def inside(bounds: Extent, x: float, y: float) -> bool:
    """Whether (x, y) lies within ``bounds``, edges included."""
    return bounds[0] <= x <= bounds[2] and bounds[1] <= y <= bounds[3]
