"""The facts about plugins for `list`, `show` and `doctor`, from separate processes."""

from collections.abc import Iterable
from typing import Any

from benchnav.api.components.plugin_page import pair_page, plugin_page, sentence
from benchnav.errors import BenchnavError, PluginError
from benchnav.metrics.measure import is_own
from benchnav.navigation.command_check import short
from benchnav.navigation.hierarchy.composition import HIERARCHICAL
from benchnav.navigation.plugin.configure import make, split
from benchnav.navigation.plugin.plugin_process import (
    IMPORT,
    Plugin,
    StepCallback,
    query_plugins,
    serve,
)
from benchnav.navigation.plugin.trace import plain
from benchnav.plugins import (
    CONTROLLERS,
    METRICS,
    NAVIGATORS,
    PLANNERS,
    TRAINERS,
    Registry,
)
from benchnav.processes.channel import Channel
from benchnav.source.parts import local_names

SENTENCE, MADE, PAGE, PAIR = "sentence", "made", "page", "pair"  # kinds of facts
_TIMEOUT = 30.0  # [s] for an import or a construction
_MADE = (NAVIGATORS, PLANNERS, CONTROLLERS)  # plugins that `benchnav run` makes from a Config
_REGISTRIES = {r.kind: r for r in (NAVIGATORS, PLANNERS, CONTROLLERS, METRICS, TRAINERS)}


def inspect_plugins(
    registry: Registry, names: Iterable[str], fact: str
) -> dict[str, str | BenchnavError]:
    """Return the facts about each plugin, or the reason why it cannot be used.

    Plugins of one distribution share a process. Plugins of benchnav, and plugins that only this
    process knows, are loaded in this process.
    """
    found: dict[str, str | BenchnavError] = {}
    groups: dict[str, list[Plugin]] = {}
    names = list(names)
    for name in names:
        question = {"kind": registry.kind, "name": name, "fact": fact}
        try:
            source = registry.source(HIERARCHICAL if fact == PAIR else name)
        except PluginError as error:  # two distributions claim it
            found[name] = error
            continue
        if _is_known_here(registry, name) or (registry is METRICS and is_own(name)):
            found[name] = _here(question)
        else:
            plugin = Plugin(registry.kind, name, "", question)
            groups.setdefault(source.distribution, []).append(plugin)
    answers = query_plugins(f"{__name__}:serve_inspections", list(groups.values()), _TIMEOUT)
    for group, answered in zip(groups.values(), answers, strict=True):
        for plugin, answer in zip(group, answered, strict=True):
            known = isinstance(answer, BenchnavError)
            found[plugin.name] = answer if known else _cleaned(answer, fact)
    return {name: found[name] for name in names}


def serve_inspections(channel: Channel, notes: "memoryview[float]") -> None:
    """Send the requested facts about plugins. Runs in a separate process."""
    serve(channel, notes, _inspected)


def _inspected(question: Any, on_step: StepCallback) -> str:
    registry, name, fact = _REGISTRIES[question["kind"]], question["name"], question["fact"]
    on_step(IMPORT)
    if fact == PAIR:
        return pair_page(name)
    plugin = registry.load(name)
    if fact == SENTENCE:
        return short(sentence(plugin))
    if fact == PAGE:
        return plugin_page(registry, name)
    if registry in _MADE:
        declared = getattr(plugin, "Config", None)
        required = getattr(declared, "model_fields", {}).values()
        if not any(field.is_required() for field in required):
            on_step("__init__")
            make(registry, name)
    return ""


def _is_known_here(registry: Registry, name: str) -> bool:
    """Whether only this process knows the plugin or a part of it."""
    if registry is not NAVIGATORS:
        return registry.is_local(name)
    try:
        full, parameters = split(registry, name)
    except PluginError:  # it is invalid in every process
        return False
    return bool(local_names({"type": full, **parameters}))


def _here(question: Any) -> str | BenchnavError:
    try:
        return _inspected(question, lambda step: None)
    except BenchnavError as error:
        return error


def _cleaned(answer: Any, fact: str) -> str:
    return plain(answer) if fact in (PAGE, PAIR) else short(answer)
