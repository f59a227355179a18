"""Groups of obstacles: static ones that may be relocated, dynamic ones that never yield."""

from pydantic import Field, model_validator

from benchnav.config.validation import FieldError
from benchnav.scenario.base import Distance, Places, Point, Spec, listed
from benchnav.scenario.law import Law, RecordedTrack
from benchnav.scenario.sampling.region import Region
from benchnav.scenario.sampling.sampler import Count, NonNegativeScalar, Scalar, fixed
from benchnav.scenario.shape import Movable, Shape, shape_is_fixed


class StaticGroup(Spec):
    """Static obstacles at given points, or at random points of a region."""

    shape: Shape = Field(description="shape of each obstacle")
    count: Count | None = Field(None, description="number of obstacles; default: 1; not with `at`")
    at: Places | None = Field(
        None, description="[x, y], or a list of such points with one obstacle at each [m]"
    )
    region: Region | None = Field(None, description="region of the random positions")
    heading: Scalar = Field(0.0, description="rotation [rad] of the shape, counter-clockwise")
    gap: Distance = Field(
        0.0,
        description="smallest gap [m] to walls, other obstacles, and fixed starts and goals",
    )
    moved: bool | Distance = Field(
        False,
        description="whether obstacles moved just before the episode: `true`, to another random"
        " point of the region; a number [m], by this distance. The stale map shows the old places",
    )
    relocate_at: NonNegativeScalar | None = Field(
        None, description="time [s] in the episode at which each obstacle moves, once"
    )

    @model_validator(mode="after")
    def _check(self) -> "StaticGroup":
        if (self.at is None) == (self.region is None):
            raise FieldError((), "must have either `at` or `region`")
        if self.at is not None:
            if self.count is not None:
                raise FieldError(("count",), "must not be given with `at`: it has one per point")
            if self.was_moved or self.relocate_at is not None:
                key = "moved" if self.was_moved else "relocate_at"
                raise FieldError((key,), "needs a `region` to re-place obstacles in, not `at`")
        if self.was_moved and self.relocate_at is not None:
            raise FieldError(("moved",), "must not be given with `relocate_at`: choose one")
        return self

    @property
    def points(self) -> tuple[Point, ...]:
        """The obstacles' places; none if they are drawn."""
        return listed(self.at)

    @property
    def was_moved(self) -> bool:
        """Whether the stale map may show another place, even one 0 m away."""
        return self.moved is not False

    @property
    def fixed(self) -> bool:
        """Whether every draw is the same."""
        return self.at is not None and shape_is_fixed(self.shape) and fixed(self.heading)


class DynamicGroup(Spec):
    """Dynamic obstacles: each follows a motion law."""

    shape: Movable = Field(description="shape of each obstacle")
    law: Law = Field(description="motion law")
    count: Count | None = Field(None, description="number of obstacles; default: 1; not with `at`")
    at: Places | None = Field(
        None, description="[x, y], or a list of such points with one obstacle at each [m]"
    )
    region: Region | None = Field(
        None, description="region of the random origins of the motion laws"
    )
    heading: Scalar = Field(0.0, description="rotation [rad] of the shape, constant while it moves")
    gap: Distance = Field(
        0.0, description="smallest gap [m] from the swept path to walls and static obstacles"
    )

    @model_validator(mode="after")
    def _check(self) -> "DynamicGroup":
        if isinstance(self.law, RecordedTrack):
            for key in ("at", "region", "count"):
                if getattr(self, key) is not None:
                    raise FieldError(
                        (key,), "must not be given: recorded tracks say where they are"
                    )
            return self
        if (self.at is None) == (self.region is None):
            raise FieldError((), "must have either `at` or `region`")
        if self.at is not None and self.count is not None:
            raise FieldError(("count",), "must not be given with `at`: it has one per point")
        return self

    @property
    def points(self) -> tuple[Point, ...]:
        """The origins of the laws; none if they are drawn or recorded."""
        return listed(self.at)
