"""A recording of people; the evaluated robot may replace one of them."""

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from benchnav.config.validation import FieldError
from benchnav.scenario.base import Distance, Length, Point, Spec
from benchnav.scenario.law import (
    COLUMNS_TEXT,
    FORMAT_TEXT,
    GAPS_TEXT,
    Columns,
    FrameTime,
    Gaps,
    Time,
    TrackFormat,
    check_columns,
)
from benchnav.scenario.team import NavigatorChoice, named


class Recording(Spec):
    """Recorded people: each appears at its first time and vanishes after its last.

    The evaluated robot takes the start, the goal and the time of one of them: its episode begins
    when that person appears, and the person is left out.
    """

    file: str = Field(
        min_length=1,
        max_length=500,
        description="file of the recording, relative to the scenario file",
    )
    format: TrackFormat = Field("text", description=FORMAT_TEXT)
    columns: Columns | None = Field(None, description=COLUMNS_TEXT)
    frame_time: FrameTime = Field(description="time [s] between successive frame numbers")
    scale: Length = Field(1.0, description="metres [m] per unit of the recording")
    offset: Point = Field((0.0, 0.0), description="shift [m] after scaling: [x, y]")
    gaps: Gaps = Field("refuse", description=GAPS_TEXT)
    radius: Length = Field(0.2, description="radius [m] of a person, a disc")
    replace: Literal["random", "none"] | int = Field(
        "random",
        description="id of the person that the robot replaces; `random`: one that the seed draws;"
        " `none`: no person, so that the teams need their own starts and goals",
    )
    min_distance: Distance = Field(
        0.0, description="smallest distance [m] from start to goal of a person who is drawn"
    )
    begin: Time = Field(0.0, description="time [s] in the recording at t = 0, with `replace: none`")
    driver: (
        Annotated[
            NavigatorChoice, BeforeValidator(named, json_schema_input_type=str | NavigatorChoice)
        ]
        | None
    ) = Field(
        None,
        description="navigator that moves the other people, from their recorded starts to their"
        " recorded goals, so that they react; default: they follow the recording and never yield",
    )

    @model_validator(mode="after")
    def _check(self) -> "Recording":
        if self.columns is not None:
            check_columns(self.columns, self.format)
        if self.begin > 0.0 and self.replace != "none":
            raise FieldError(("begin",), "must not be given unless `replace` is `none`")
        if self.driver is not None and self.driver.type == "evaluated":
            raise FieldError(("driver",), "must be a background navigator, not `evaluated`")
        return self
