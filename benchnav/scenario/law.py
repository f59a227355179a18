"""Motion laws of dynamic obstacles."""

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field, model_validator

from benchnav.config.validation import FieldError
from benchnav.scenario.base import Coordinate, Length, Point, Spec
from benchnav.scenario.canonical import added_field
from benchnav.scenario.sampling.sampler import NonNegativeScalar, PositiveScalar, Scalar, Uniform

_ANY_PHASE = Uniform(uniform=(0.0, 1.0))
Time = Annotated[float, Field(ge=0, le=1e6)]
TrackFormat = Literal["trajnetpp", "text"]
FrameTime = Annotated[float, Field(gt=0, le=1e4)]
Gaps = Literal["refuse", "split", "bridge"]
Columns = Annotated[
    tuple[Literal["frame", "id", "x", "y", "_"], ...], Field(min_length=4, max_length=100)
]
FORMAT_TEXT = "`trajnetpp`: TrajNet++; `text`: a table with columns frame, id, x, y"
COLUMNS_TEXT = (
    "columns of a text file, such as [frame, id, x, _, y], where `_` is ignored; default: those of"
    " its header, or frame, id, x, y, or the eight of an ETH/UCY obsmat.txt"
)
GAPS_TEXT = (
    "what to do with a gap in a track, a time without rows that is longer than 1 s and than two"
    " steps of the recording: `refuse` the file; `split` the track, so that a person vanishes and"
    " another appears; `bridge` it in a straight line"
)


class BackAndForth(Spec):
    """The obstacle moves back and forth on a straight track, centred at its origin."""

    type: Literal["back-and-forth"]
    length: PositiveScalar = Field(description="length [m] of the track")
    speed: PositiveScalar = Field(description="constant speed [m/s]")
    direction: Scalar = Field(
        Uniform(uniform=(0.0, 6.283185307179586)), description="direction [rad] of the track"
    )
    phase: Scalar = Field(_ANY_PHASE, description="fraction of the period at t = 0")


class WaypointLoop(Spec):
    """The obstacle moves along straight lines from waypoint to waypoint, in a closed loop."""

    type: Literal["waypoint-loop"]
    points: tuple[Point, ...] = Field(
        min_length=2,
        max_length=1000,
        description="waypoints [m], relative to the origin of the law",
    )
    speed: PositiveScalar = Field(description="constant speed [m/s]")
    phase: Scalar = Field(_ANY_PHASE, description="fraction of the period at t = 0")

    @model_validator(mode="after")
    def _check(self) -> "WaypointLoop":
        following = (*self.points[1:], self.points[0])
        if any(a == b for a, b in zip(self.points, following, strict=True)):
            raise FieldError(("points",), "must not hold the same point twice in a row")
        return self


class CircleLaw(Spec):
    """The obstacle moves on a circle, centred at its origin."""

    type: Literal["circle"]
    radius: PositiveScalar = Field(description="radius [m] of the circle")
    speed: NonNegativeScalar = Field(description="constant speed [m/s] along the circle")
    clockwise: bool = Field(False, description="whether it moves clockwise")
    phase: Scalar = Field(_ANY_PHASE, description="fraction of the circle at t = 0")


class RecordedTrack(Spec):
    """A recording in the arena's frame: a file, or points in the scenario.

    The first frame of a file is at t = 0. Outside its times, an obstacle stands at its first or
    last point, or is absent.
    """

    type: Literal["recorded-track"]
    file: str | None = Field(
        None,
        min_length=1,
        max_length=500,
        description="file of the recording, relative to the scenario file",
    )
    format: TrackFormat | None = Field(None, description=FORMAT_TEXT)
    columns: Columns | None = added_field(None, "0.3", description=COLUMNS_TEXT)
    frame_time: FrameTime | None = Field(
        None, description="time [s] between successive frame numbers; required with `file`"
    )
    ids: tuple[int, ...] | None = Field(
        None, min_length=1, description="ids to replay; default: all"
    )
    points: tuple[tuple[Time, Coordinate, Coordinate], ...] | None = Field(
        None,
        min_length=1,
        max_length=10000,
        description="[time s, x m, y m] with rising times, in place of a file",
    )
    scale: Length = Field(1.0, description="metres [m] per unit of the recording")
    offset: Point = Field((0.0, 0.0), description="shift [m] after scaling: [x, y]")
    repeat: bool = Field(False, description="whether the recording starts again at its end")
    gaps: Gaps = added_field("refuse", "0.3", description=GAPS_TEXT)
    presence: Literal["always", "recorded"] = added_field(
        "always",
        "0.3",
        description="`always`: before its first time an obstacle stands at its first point, and"
        " after its last time at its last point; `recorded`: it is absent then",
    )

    @model_validator(mode="after")
    def _check(self) -> "RecordedTrack":
        if self.presence == "recorded" and self.repeat:
            raise FieldError(("repeat",), "must be false with `presence: recorded`")
        if self.gaps == "split" and self.presence == "always":
            raise FieldError(("gaps",), "must not be `split` without `presence: recorded`")
        if self.columns is not None:
            check_columns(self.columns, self.format)
        if (self.file is None) == (self.points is None):
            raise FieldError((), "must have either `file` or `points`")
        if self.points is not None:
            times = [t for t, _, _ in self.points]
            if any(b <= a for a, b in pairwise(times)):
                raise FieldError(("points",), "must have rising times")
            for key in ("format", "columns", "frame_time", "ids"):
                if getattr(self, key) is not None:
                    raise FieldError((key,), "belongs to a `file`, not to `points`")
            return self
        for key in ("format", "frame_time"):
            if getattr(self, key) is None:
                raise FieldError((key,), "must be given with a `file`")
        return self


def check_columns(columns: Columns, format: TrackFormat | None) -> None:
    """Raise FieldError unless the columns can be those of a text file."""
    if format != "text":
        raise FieldError(("columns",), "belong to the format `text`")
    for name in ("frame", "id", "x", "y"):
        if columns.count(name) != 1:
            raise FieldError(("columns",), f"must name {name!r} once")


Law = Annotated[
    BackAndForth | WaypointLoop | CircleLaw | RecordedTrack, Field(discriminator="type")
]
