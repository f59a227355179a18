"""Introductions of navigators that are made in processes of their own."""

import os
import re
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from pydantic import TypeAdapter, ValidationError

from benchnav.arena.sensing import Sensing
from benchnav.errors import BenchnavError, PluginError
from benchnav.navigation.plugin.capabilities import Introduction, lie, meet
from benchnav.navigation.plugin.configure import Spec, split
from benchnav.navigation.plugin.plugin_process import TIMEOUT, Plugin, Stepping, ask_plugins, tell
from benchnav.plugins import NAVIGATORS
from benchnav.processes.channel import Channel
from benchnav.source.parts import places_of

_SENSINGS = TypeAdapter(list[Sensing])


def introductions(
    asked: Sequence[tuple[Spec, str]], sensings: Sequence[Sensing], timeout: float = TIMEOUT
) -> list[Introduction | BenchnavError]:
    """What navigators say of themselves, in processes of their own.

    Those of one author share a process, which imports their modules once.

    Args:
        asked: (spec, what it stands at) of each.
        sensings: as in `meet`.
        timeout: [s] that a call of a navigator may last.

    An error, which is the answer of one that cannot be used, is what `meet` raises.
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
        for spec, where in asked
    ]  # fmt: skip
    groups: dict[frozenset[str], list[Plugin]] = {}
    for plugin in plugins:
        groups.setdefault(_authors(plugin), []).append(plugin)
    answers = ask_plugins(f"{__name__}:introduce", list(groups.values()), timeout)
    found = {
        id(plugin): _understood(plugin, answer)
        for group, answered in zip(groups.values(), answers, strict=True)
        for plugin, answer in zip(group, answered, strict=True)
    }
    return [found[id(plugin)] for plugin in plugins]


def _authors(plugin: Plugin) -> frozenset[str]:
    """Top-level modules whose code makes it."""
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


def _understood(plugin: Plugin, answer: Any) -> Introduction | BenchnavError:
    if isinstance(answer, BenchnavError):
        return answer
    try:
        return Introduction.model_validate_json(answer)
    except ValidationError as error:
        return plugin.broken(lie(error).removesuffix("."))


def introduce(channel: Channel, notes: "memoryview[float]") -> None:
    """Introduce the navigators that the channel asks for. Of a process of its own."""
    tell(channel, notes, _told)


def _told(question: Any, stepping: Stepping) -> str:
    os.environ.clear()  # it is no worker yet, and sees what the user set
    os.environ.update(question["environment"])
    sensings = _SENSINGS.validate_python(question["sensings"])
    _, introduction = meet(question["spec"], sensings, where=question["where"], stepping=stepping)
    return introduction.model_dump_json(exclude_defaults=True)
