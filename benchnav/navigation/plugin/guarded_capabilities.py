"""The properties of navigators, read in separate processes."""

import os
import re
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from pydantic import TypeAdapter, ValidationError

from benchnav.arena.sensing import Sensing
from benchnav.errors import BenchnavError, PluginError
from benchnav.navigation.plugin.capabilities import (
    Capabilities,
    inspect_navigator,
    invalid_property,
)
from benchnav.navigation.plugin.configure import Spec, split
from benchnav.navigation.plugin.plugin_process import (
    TIMEOUT,
    Plugin,
    StepCallback,
    query_plugins,
    serve,
)
from benchnav.plugins import NAVIGATORS
from benchnav.processes.channel import Channel
from benchnav.source.parts import places_of

_SENSINGS = TypeAdapter(list[Sensing])


def read_guarded_capabilities(
    specs: Sequence[tuple[Spec, str]], sensings: Sequence[Sensing], timeout: float = TIMEOUT
) -> list[Capabilities | BenchnavError]:
    """Return the properties of each navigator, or the error of `inspect_navigator`.

    Navigators with code of the same modules share a process, which imports the modules once.

    Args:
        specs: (spec, its place for messages) of each navigator.
        sensings: as in `inspect_navigator`.
        timeout: [s] that a call of a navigator may last.
    """
    fields = [asdict(sensing) for sensing in sensings]
    plugins = [
        Plugin(
            "navigator", _written(spec), where,
            {
                "spec": spec if isinstance(spec, str) else dict(spec), "where": where,
                "sensings": fields, "environment": dict(os.environ),
            },
        )
        for spec, where in specs
    ]  # fmt: skip
    groups: dict[frozenset[str], list[Plugin]] = {}
    for plugin in plugins:
        groups.setdefault(_authors(plugin), []).append(plugin)
    answers = query_plugins(f"{__name__}:serve_capabilities", list(groups.values()), timeout)
    found = {
        id(plugin): _understood(plugin, answer)
        for group, answered in zip(groups.values(), answers, strict=True)
        for plugin, answer in zip(group, answered, strict=True)
    }
    return [found[id(plugin)] for plugin in plugins]


def _authors(plugin: Plugin) -> frozenset[str]:
    """Return the top-level modules with the code of a navigator."""
    spec = plugin.question["spec"]
    try:
        name, parameters = split(NAVIGATORS, spec)
        places = places_of({"type": name, **parameters})
    except PluginError:
        places = ()
    tops = frozenset(re.split("[.:]", place)[0] for place in places)
    return tops - {"benchnav"} or tops


def _written(spec: Spec) -> str:
    return spec if isinstance(spec, str) else str(spec.get("type", ""))


def _understood(plugin: Plugin, answer: Any) -> Capabilities | BenchnavError:
    if isinstance(answer, BenchnavError):
        return answer
    try:
        return Capabilities.model_validate_json(answer)
    except ValidationError as error:
        return plugin.broken(invalid_property(error).removesuffix("."))


def serve_capabilities(channel: Channel, notes: "memoryview[float]") -> None:
    """Send the properties of navigators to the channel. Runs in a separate process."""
    serve(channel, notes, _properties)


def _properties(question: Any, on_step: StepCallback) -> str:
    os.environ.clear()  # a navigator that is not in a worker sees the user's environment
    os.environ.update(question["environment"])
    sensings = _SENSINGS.validate_python(question["sensings"])
    _, capabilities = inspect_navigator(
        question["spec"], sensings, where=question["where"], on_step=on_step
    )
    return capabilities.model_dump_json(exclude_defaults=True)
