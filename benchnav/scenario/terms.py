"""The terms of an episode: clock, rules, sensing and knowledge."""

import math
from typing import Literal, get_args

from pydantic import Field, model_validator

from benchnav.config.validation import FieldError
from benchnav.scenario.base import Length, Spec
from benchnav.scenario.canonical import added_field

Track = Literal["known", "stale", "partial", "unknown"]
TRACKS: tuple[Track, ...] = get_args(Track)
Perception = Literal["exact", "noisy"]
PERCEPTIONS: tuple[Perception, ...] = get_args(Perception)
SPLITS = ("train", "validation", "test")
MAX_STEPS = 100_000


class Clock(Spec):
    """Time steps of an episode."""

    dt: float = Field(0.2, gt=0, le=10, description="time [s] between decisions")
    substeps: int = Field(2, ge=1, le=100, description="integration steps per decision")
    horizon: float = Field(
        50.0, gt=0, le=1e5, description="time limit [s] of an episode; a multiple of `dt`"
    )
    decision_budget: float | None = Field(
        None, gt=0, le=1e3, description="time limit [s] of a decision; measured, not enforced"
    )

    @property
    def steps(self) -> int:
        """The number of decisions until the horizon."""
        return round(self.horizon / self.dt)

    @model_validator(mode="after")
    def _check(self) -> "Clock":
        steps = self.horizon / self.dt
        if steps > MAX_STEPS:
            raise FieldError(
                ("horizon",), f"must be at most {MAX_STEPS} steps of dt; it is {steps:g}"
            )
        if round(steps) < 1 or abs(steps - round(steps)) > 1e-6:
            near = max(1, math.floor(steps)) * self.dt
            raise FieldError(
                ("horizon",),
                f"must be a whole number of steps of dt = {self.dt:g}; got {self.horizon:g},"
                f" nearest are {near:.6g} and {near + self.dt:.6g}",
            )
        return self


class Rules(Spec):
    """The conditions of arrival, and the effects of contacts."""

    goal_tolerance: Length = Field(
        0.5, description="distance [m] from centre to goal at which an agent arrives"
    )
    contact: Literal["slide", "stop", "end"] = Field(
        "slide",
        description="effect of a contact on an agent: it slides along the surface, it stops until"
        " its next decision, or its attempt ends",
    )
    on_arrival: Literal["vanish", "stay"] = Field(
        "stay", description="whether an agent that arrived leaves the world or stays as an obstacle"
    )
    on_end: Literal["vanish", "stay"] = Field(
        "stay", description="the same, after a contact that ends the attempt"
    )
    charge: Literal["hitter", "both"] = Field(
        "hitter",
        description="agent that is charged with a collision between an active agent and one that"
        " stays after its attempt: the active one, or both",
    )


class Rays(Spec):
    """A fan of range sensor rays, symmetric about the heading."""

    count: int = Field(7, ge=1, le=1000, description="number of rays")
    fan: float = Field(
        math.pi, gt=0, le=2 * math.pi, description="angle [rad] between the outermost rays"
    )
    range: Length = Field(8.0, description="length [m] of a ray")
    thick: bool = Field(
        True, description="whether a ray is as wide as the agent (a sphere cast) or a line"
    )
    thickness: Literal["inscribed", "circumscribed"] = added_field(
        "inscribed",
        "0.3.0",
        description="circle of a `footprint` that a thick ray is as wide as: the largest circle"
        " within the body, or the smallest around it",
    )

    @model_validator(mode="after")
    def _check(self) -> "Rays":
        if self.thickness != "inscribed" and not self.thick:
            raise FieldError(
                ("thickness",), "must not be given if `thick` is false: a thin ray has no width"
            )
        return self


class Nearest(Spec):
    """The nearest objects within a range."""

    count: int = Field(10, ge=1, le=1000, description="largest number of objects")
    range: Length = Field(10.0, description="largest distance [m]")


class Sensing(Spec):
    """The sensors of every agent; `null` removes a sensor."""

    rays: Rays | None = Field(Rays(), description="range sensor")
    neighbours: Nearest | None = Field(
        Nearest(count=10, range=10.0), description="nearest agents and dynamic obstacles"
    )
    edges: Nearest | None = Field(
        Nearest(count=16, range=8.0), description="nearest edges of walls and static obstacles"
    )
    occlusion: bool = Field(
        True, description="whether walls and obstacles hide objects behind them"
    )
