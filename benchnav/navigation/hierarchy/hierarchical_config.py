"""The parameters that every pair of planner and controller has."""

from typing import Any, Self

from pydantic import Field, field_validator, model_validator

from benchnav.navigation.hierarchy.composition import NO_PLANNER
from benchnav.navigation.hierarchy.mapping import MappingConfig
from benchnav.navigation.hierarchy.replanning import Replan
from benchnav.navigation.navigator import PluginConfig
from benchnav.navigation.plugin.configure import configure, split
from benchnav.plugins import PLANNERS, Registry

PartSpec = str | dict[str, Any]


class GuidedConfig(PluginConfig):
    """Of the planner, of planning again, and of following a path."""

    planner: PartSpec = Field(
        description="a planner: name or {type: name, …}; none: the goal is the target, and no map"
        " is needed",
    )
    mapping: MappingConfig | None = Field(
        None,
        description="true or {…}: plan on a map that is made of the granted one, if there is any,"
        " and of what the agents sense",
    )
    replan: Replan | None = Field(
        None,
        description="when to plan again: never; when the map changes (map-change); when the rest"
        " of the path leads through what the map now holds, or there was no path and the map"
        " changed (blocked); at intervals ({every: seconds}); or a list of these. Unless told:"
        " blocked with mapping, else map-change",
    )
    pause: float = Field(
        0.4,
        ge=0,
        description="[s] at least between plans of an agent because its path is blocked, or because"
        " of what mapping learned",
    )
    patience: float = Field(
        4.0,
        gt=0,
        description="[s] without getting a radius away, after which an agent that may"
        " plan again does (twice as long if that does not help, and so on): others can push it"
        " round a corner that its path does not turn",
    )
    give_way: float = Field(
        0.0,
        ge=0,
        le=1,
        description="probability that an agent whose patience ends goes back the way it came for 2"
        " to 6 s before it plans again: two that meet in a door wait for each other otherwise",
    )
    lookahead: float | None = Field(
        None,
        gt=0,
        description="[m] of path between agent and target, at most; unless told, as the controller"
        " declares",
    )
    cut: float | None = Field(
        None,
        gt=0,
        description="[m] by which corners of the path may be missed; unless told, as the controller"
        " declares",
    )

    @field_validator("mapping", mode="before")
    @classmethod
    def _take_a_flag(cls, given: Any) -> Any:
        return MappingConfig() if given is True else None if given is False else given

    @field_validator("planner")
    @classmethod
    def _resolve_planner(cls, part: PartSpec) -> PartSpec:
        return part if part == NO_PLANNER else resolved(PLANNERS, part)

    @model_validator(mode="after")
    def _refuse_a_map_for_nobody(self) -> Self:
        if self.mapping is not None and self.planner == NO_PLANNER:
            raise ValueError("given a planner where it maps")
        return self


def resolved(registry: Registry, part: PartSpec) -> dict[str, Any]:
    """``{type: name, …every parameter}`` of a part.

    Raises what `benchnav.navigation.plugin.configure.configure` raises.
    """
    name, _ = split(registry, part, where=registry.kind)
    _, config = configure(registry, part, where=registry.kind)
    return {"type": name, **config.model_dump(mode="json")}
