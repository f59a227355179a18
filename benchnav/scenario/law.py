"""Motion laws of dynamic obstacles."""

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field, model_validator

from benchnav.config.validation import FieldError
from benchnav.scenario.base import Coordinate, Length, Point, Spec
from benchnav.scenario.sampling.sampler import NonNegativeScalar, PositiveScalar, Scalar, Uniform

_ANY_PHASE = Uniform(uniform=(0.0, 1.0))
Time = Annotated[float, Field(ge=0, le=1e6)]


class BackAndForth(Spec):
    """Back and forth on a straight track that is centred where the obstacle is placed."""

    type: Literal["back-and-forth"]
    length: PositiveScalar = Field(description="of the track [m]")
    speed: PositiveScalar = Field(description="[m/s]")
    direction: Scalar = Field(
        Uniform(uniform=(0.0, 6.283185307179586)), description="of the track [rad]"
    )
    phase: Scalar = Field(_ANY_PHASE, description="share of the period that has passed at t = 0")


class WaypointLoop(Spec):
    """A closed loop of straight lines through waypoints."""

    type: Literal["waypoint-loop"]
    points: tuple[Point, ...] = Field(
        min_length=2, max_length=1000, description="relative to where the obstacle is placed [m]"
    )
    speed: PositiveScalar = Field(description="[m/s]")
    phase: Scalar = Field(_ANY_PHASE, description="share of the period that has passed at t = 0")

    @model_validator(mode="after")
    def _check(self) -> "WaypointLoop":
        following = (*self.points[1:], self.points[0])
        if any(a == b for a, b in zip(self.points, following, strict=True)):
            raise FieldError(("points",), "must not hold the same point twice in a row")
        return self


class CircleLaw(Spec):
    """A circle that is centred where the obstacle is placed."""

    type: Literal["circle"]
    radius: PositiveScalar = Field(description="[m]")
    speed: NonNegativeScalar = Field(description="along the circle [m/s]")
    clockwise: bool = False
    phase: Scalar = Field(_ANY_PHASE, description="share of the circle that has passed at t = 0")


class RecordedTrack(Spec):
    """A recording in the arena's frame: a file, or points in the scenario.

    An obstacle stands at its first point until its first time, and at its last
    point after its last time. The recording starts at its first frame.
    """

    type: Literal["recorded-track"]
    file: str | None = Field(
        None, min_length=1, max_length=500, description="relative to the scenario file"
    )
    format: Literal["trajnetpp", "text"] | None = Field(
        None, description="text has four columns: frame, id, x, y"
    )
    frame_time: Annotated[float, Field(gt=0, le=1e4)] | None = Field(
        None, description="[s] from one frame number to the next; never guessed"
    )
    ids: tuple[int, ...] | None = Field(None, min_length=1, description="all, if not given")
    points: tuple[tuple[Time, Coordinate, Coordinate], ...] | None = Field(
        None, min_length=1, max_length=10000, description="[time s, x m, y m], times rising"
    )
    scale: Length = Field(1.0, description="[m] per unit of the recording")
    offset: Point = Field((0.0, 0.0), description="added after scaling [m]")
    repeat: bool = Field(False, description="start again after the last time")

    @model_validator(mode="after")
    def _check(self) -> "RecordedTrack":
        if (self.file is None) == (self.points is None):
            raise FieldError((), "must have either `file` or `points`")
        if self.points is not None:
            times = [t for t, _, _ in self.points]
            if any(b <= a for a, b in pairwise(times)):
                raise FieldError(("points",), "must have rising times")
            for key in ("format", "frame_time", "ids"):
                if getattr(self, key) is not None:
                    raise FieldError((key,), "belongs to a `file`, not to `points`")
            return self
        for key in ("format", "frame_time"):
            if getattr(self, key) is None:
                raise FieldError((key,), "must be given with a `file`")
        return self


Law = Annotated[
    BackAndForth | WaypointLoop | CircleLaw | RecordedTrack, Field(discriminator="type")
]
