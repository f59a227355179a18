"""The page of a plugin for `benchnav show`, from a process in which its code may run."""

import inspect
from typing import Any

from benchnav.api.components.parameter_text import answers, bodies, drives, needs, parameters
from benchnav.navigation.hierarchy.composition import MAPPING, NO_PLANNER
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import CONTROLLERS, METRICS, NAVIGATORS, PLANNERS, TRAINERS, Registry
from benchnav.text.columns import columns


def plugin_page(registry: Registry, name: str) -> str:
    """Return the page of the plugin ``name``: description, needs and parameters."""
    thing, source = registry.load(name), registry.source(name)
    facts = [("is", f"a {registry.kind}: {sentence(thing)}")]
    facts.append(("comes from", f"{source.distribution}, {source.value}{_place(thing)}"))
    if registry is METRICS:
        facts += _metric_facts(thing)
    if registry is TRAINERS:
        recipes = ", ".join(path.stem for path in sorted(thing.recipes.glob("*.yaml")))
        facts.append(("recipes", recipes or "none"))
    if registry in (NAVIGATORS, CONTROLLERS):
        facts.append(("needs", needs(registry, name)))
        facts.append(("drives", drives(registry, name)))
        facts.append(("answers", answers(registry, name)))
    text = f"{name}\n" + columns([("  " + key, value) for key, value in facts])
    return f"{text}\n  parameters\n{_parameters(thing)}" if hasattr(thing, "Config") else text


def pair_page(name: str) -> str:
    """Return the page of a navigator that is named by its parts, and the pages of its parts."""
    navigator = make(NAVIGATORS, name)
    distributions = dict.fromkeys(part.distribution for part in navigator.parts)
    facts = [
        ("is", f"a navigator: {sentence(type(navigator))}"),
        ("comes from", ", ".join(distributions)),
        ("needs", needs(NAVIGATORS, name)),
        ("drives", bodies(navigator.drives)),
        ("answers", f"a {navigator.command} per agent"),
    ]
    head = f"{name}\n" + columns([("  " + key, value) for key, value in facts])
    others = _parameters(type(navigator), named=(PLANNERS.kind, CONTROLLERS.kind, MAPPING))
    pages = [f"{head}\n  parameters in addition to those of its parts\n{others}"]
    planner, controller = name.split("+")[-2:]
    if planner != NO_PLANNER:
        pages.append(plugin_page(PLANNERS, planner))
    return "\n\n".join([*pages, plugin_page(CONTROLLERS, controller)])


def _metric_facts(metric: Any) -> list[tuple[str, str]]:
    facts = [
        ("unit", metric.unit or "none"),
        ("better", metric.better or "neither: descriptive, never ranked"),
        ("range", f"{metric.low:g} to {metric.high:g}"),
        ("per", metric.scope),
    ]
    if metric.conditional:
        facts.append(("of", "agents that arrive: it shows their number, and never ranks"))
    return [*facts, ("reference", metric.reference)]


def _parameters(plugin: Any, named: tuple[str, ...] = ()) -> str:
    """Return one line per parameter, without those in ``named``."""
    rows = [("    " + row[0], *row[1:]) for row in parameters(plugin) if row[0] not in named]
    return columns(rows) if rows else "    none"


def _place(thing: Any) -> str:
    try:
        path, (_, line) = inspect.getsourcefile(thing), inspect.getsourcelines(thing)
    except (TypeError, OSError):
        return ""
    return f" ({path}:{line})"


def sentence(thing: object) -> str:
    """Return the description of a plugin: a metric's title, or the first line of a docstring."""
    title = getattr(thing, "title", None)
    if isinstance(title, str):
        return title
    text = inspect.getdoc(thing) or ""
    return text.partition("\n")[0]
