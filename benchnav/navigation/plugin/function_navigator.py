"""Navigators that call a function."""

import inspect
from collections.abc import Callable, Sequence
from typing import Any

from pydantic import Field

from benchnav.arrays import FloatArray
from benchnav.errors import PluginError
from benchnav.named_module import load_by_module
from benchnav.navigation.agent_view import AgentView
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.navigator import AgentNavigator, Navigator, PluginConfig
from benchnav.navigation.observation import Observation

RULE = (
    "A function that is a navigator takes one argument, the observation of a batch of worlds,"
    " or two, the view and the briefing of one agent"
)


class FunctionConfig(PluginConfig):
    """The parameters of `BatchFunction` and `AgentFunction`."""

    function: str = Field(description="module:name of the function")


class BatchFunction(Navigator):
    """Calls a function of an observation, which returns the commands (B, A, 2) of a batch."""

    Config = FunctionConfig
    function: Callable[..., Any] | None = None  # of a class that was made for one function

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._call = _function_of(self)

    def act(self, observation: Observation) -> FloatArray:
        commands: FloatArray = self._call(observation)
        return commands


class AgentFunction(AgentNavigator):
    """Calls a function of a view and a briefing, which returns the command (2,) of one agent."""

    Config = FunctionConfig
    function: Callable[..., Any] | None = None

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._call = _function_of(self)

    def act_agent(self, view: AgentView, briefing: Briefing) -> FloatArray | Sequence[float]:
        command: FloatArray | Sequence[float] = self._call(view, briefing)
        return command


def function_class(function: Callable[..., Any]) -> type[BatchFunction | AgentFunction]:
    """Return the class for a function, which follows from the number of its arguments.

    Raises PluginError for a function with another number of arguments.
    """
    try:
        parameters = list(inspect.signature(function).parameters.values())
    except (TypeError, ValueError):
        parameters = []
    needed = [p for p in parameters if p.default is p.empty and p.kind in _POSITIONAL]
    if len(needed) in (1, 2) and all(
        p in needed or p.default is not p.empty or p.kind in _VARIABLE for p in parameters
    ):
        return BatchFunction if len(needed) == 1 else AgentFunction
    name = getattr(function, "__qualname__", repr(function))
    raise PluginError(f"{RULE}. {name} takes ({', '.join(map(str, parameters))}).")


_POSITIONAL = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
_VARIABLE = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)


def _function_of(navigator: BatchFunction | AgentFunction) -> Callable[..., Any]:
    own = type(navigator).function
    if own is not None:
        return own
    loaded: Callable[..., Any] = load_by_module(navigator.config.function)
    return loaded
