"""The terms of an episode: clock, rules, sensing and knowledge."""

import math
from typing import Annotated, Literal, get_args

from pydantic import Field, model_validator

from benchnav.config.validation import FieldError
from benchnav.scenario.base import Length, Spec

Track = Literal["known", "stale", "partial", "unknown"]
TRACKS: tuple[Track, ...] = get_args(Track)
SPLITS = ("train", "validation", "test")
MAX_STEPS = 100_000


class Clock(Spec):
    """Time."""

    dt: float = Field(0.2, gt=0, le=10, description="between decisions [s]")
    substeps: int = Field(2, ge=1, le=100, description="integration steps within a decision")
    horizon: float = Field(50.0, gt=0, le=1e5, description="when the episode ends [s]")
    decision_budget: float | None = Field(
        None, gt=0, le=1e3, description="[s] that a decision may take; scored, not enforced"
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

    goal_tolerance: Length = Field(0.5, description="between centre and goal [m]")
    contact: Literal["slide", "stop", "end"] = Field(
        "slide", description="what touching something does to an agent"
    )
    on_arrival: Literal["vanish", "stay"] = "stay"
    on_end: Literal["vanish", "stay"] = "stay"
    charge: Literal["hitter", "both"] = Field(
        "hitter", description="who is charged when one that arrived or ended, and stayed, is hit"
    )


class Rays(Spec):
    """A fan of rays, symmetric about the heading."""

    count: int = Field(7, ge=1, le=1000)
    fan: float = Field(math.pi, gt=0, le=2 * math.pi, description="between the outermost [rad]")
    range: Length = Field(8.0, description="[m]")
    thick: bool = Field(True, description="sphere casts of the agent's own radius")


class Nearest(Spec):
    """The nearest objects within a range."""

    count: Annotated[int, Field(ge=1, le=1000)] = 10
    range: Length = Field(10.0, description="[m]")


class Sensing(Spec):
    """The sensors of every agent; null for a missing kind."""

    rays: Rays | None = Rays()
    neighbours: Nearest | None = Nearest(count=10, range=10.0)
    edges: Nearest | None = Nearest(count=16, range=8.0)
    occlusion: bool = Field(True, description="what walls and obstacles hide is not sensed")
