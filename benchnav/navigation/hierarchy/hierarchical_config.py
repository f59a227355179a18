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
    """The parameters of the planner, of replanning, and of following a path."""

    planner: PartSpec = Field(
        description="a planner: name or {type: name, …}; none: the goal is the target, and no map"
        " is needed",
    )
    mapping: MappingConfig | None = Field(
        None,
        description="true or {…}: plan on a map that is made of the granted one, if there is any,"
        " and of the agents' sensor data",
    )
    replan: Replan | None = Field(
        None,
        description="when to plan again: never; when the map changes (map-change); when the map"
        " blocks the rest of the path, or there was no path and the map changed (blocked); at"
        " intervals ({every: seconds}); or a list of these. Default: blocked with mapping, else"
        " map-change",
    )
    pause: float = Field(
        0.4,
        ge=0,
        description="[s] at least between plans of an agent because its path is blocked, or because"
        " mapping changed its map",
    )
    patience: float = Field(
        4.0,
        gt=0,
        description="[s] without moving a radius away, after which an agent plans again, if it may"
        " plan again at all; the time doubles with each such plan in one place. Other agents can"
        " push it round a corner that its path does not turn",
    )
    give_way: float = Field(
        0.0,
        ge=0,
        le=1,
        description="probability that an agent whose patience ends goes back the way it came for 2"
        " to 6 s before it plans again. Otherwise two agents that meet in a door can wait for each"
        " other forever",
    )
    lookahead: float | None = Field(
        None,
        gt=0,
        description="[m] of path between agent and target, at most. Default: the controller's"
        " value",
    )
    cut: float | None = Field(
        None,
        gt=0,
        description="[m] by which the agent may miss corners of the path. Default: the controller's"
        " value",
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
    def _refuse_a_map_without_a_planner(self) -> Self:
        if self.mapping is not None and self.planner == NO_PLANNER:
            raise ValueError("given a planner if mapping is on")
        return self


def resolved(registry: Registry, part: PartSpec) -> dict[str, Any]:
    """Return ``{type: name, …every parameter}`` of a part.

    Raises what `benchnav.navigation.plugin.configure.configure` raises.
    """
    name, _ = split(registry, part, where=registry.kind)
    _, config = configure(registry, part, where=registry.kind)
    return {"type": name, **config.model_dump(mode="json")}
