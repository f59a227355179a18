"""`benchnav show`: one thing by name, with its parameters, units and source."""

import inspect
from collections.abc import Iterator
from typing import Annotated, Any

import typer

from benchnav.cli.console import columns, put
from benchnav.cli.listing import REGISTRIES, Kind, sentence
from benchnav.cli.parameters import needs, parameters
from benchnav.cli.scenario_page import scenario_page
from benchnav.errors import UsageError, did_you_mean
from benchnav.navigation.pair import MAPPING, NO_PLANNER, is_pair
from benchnav.plugins import CONTROLLERS, NAVIGATORS, PLANNERS, Registry


def show(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="Of anything that `benchnav list` lists.")
    ],
) -> None:
    """Show what a name stands for.

    Purpose, parameters with units and defaults, and where it comes from.
    """
    blocks = [
        _plugin(kind, registry, name)
        for kind, registry in REGISTRIES.items()
        if name in registry.names()
        or (kind == Kind.NAVIGATORS and _is_class(name) and not is_pair(name))
    ]
    blocks += [*_pair(name), *_scenario(name), *_suite(name)]
    if not blocks:
        raise UsageError(
            f"NAME must be something that 'benchnav list' lists. Got {name!r} instead."
            f"{did_you_mean(name, _everything())}"
        )
    put("\n\n".join(blocks))


def _is_class(name: str) -> bool:
    """True for ``module:Class``; a scenario's parameters stand behind a colon, too."""
    return ":" in name and "=" not in name


def _plugin(kind: Kind, registry: Registry, name: str) -> str:
    thing, source = registry.load(name), registry.source(name)
    facts = [("is", f"a {registry.kind}: {sentence(thing)}")]
    facts.append(("comes from", f"{source.distribution}, {source.value}{_place(thing)}"))
    if kind == Kind.METRICS:
        facts += _metric_facts(thing)
    if kind in (Kind.NAVIGATORS, Kind.CONTROLLERS):
        facts.append(("needs", needs(registry, name)))
    if isinstance(getattr(thing, "command", None), str):
        facts.append(("answers", f"a {thing.command} per agent"))
    text = f"{name}\n" + columns([("  " + key, value) for key, value in facts])
    return f"{text}\n  parameters\n{_parameters(thing)}" if hasattr(thing, "Config") else text


def _pair(name: str) -> Iterator[str]:
    """A navigator named by its parts, and these."""
    from benchnav.navigation.configure import make

    if not is_pair(name):
        return
    navigator = make(NAVIGATORS, name)
    distributions = dict.fromkeys(part.distribution for part in navigator.parts)
    facts = [
        ("is", f"a navigator: {sentence(type(navigator))}"),
        ("comes from", ", ".join(distributions)),
        ("needs", needs(NAVIGATORS, name)),
        ("answers", f"a {navigator.command} per agent"),
    ]
    head = f"{name}\n" + columns([("  " + key, value) for key, value in facts])
    others = _parameters(type(navigator), named=(PLANNERS.kind, CONTROLLERS.kind, MAPPING))
    yield f"{head}\n  parameters beside its parts'\n{others}"
    planner, controller = name.split("+")[-2:]
    if planner != NO_PLANNER:
        yield _plugin(Kind.PLANNERS, PLANNERS, planner)
    yield _plugin(Kind.CONTROLLERS, CONTROLLERS, controller)


def _metric_facts(metric: Any) -> list[tuple[str, str]]:
    facts = [
        ("unit", metric.unit or "none"),
        ("better", metric.better or "neither: it describes, and is never ranked"),
        ("range", f"{metric.low:g} to {metric.high:g}"),
        ("per", metric.scope),
    ]
    if metric.conditional:
        facts.append(("of", "those that arrived, so it shows their number and never ranks"))
    return [*facts, ("reference", metric.reference)]


def _parameters(plugin: Any, named: tuple[str, ...] = ()) -> str:
    """One line each, without those ``named`` elsewhere."""
    rows = [("    " + row[0], *row[1:]) for row in parameters(plugin) if row[0] not in named]
    return columns(rows) if rows else "    none"


def _place(thing: Any) -> str:
    try:
        path, (_, line) = inspect.getsourcefile(thing), inspect.getsourcelines(thing)
    except (TypeError, OSError):
        return ""
    return f" ({path}:{line})"


def _scenario(name: str) -> Iterator[str]:
    from benchnav.scenario.catalogue import find, is_named

    if is_named(name):
        yield scenario_page(find(name))


def _suite(name: str) -> Iterator[str]:
    from benchnav.runner.suite import load_suite
    from benchnav.runner.suite_file import suite_names

    if name not in suite_names():
        return
    suite = load_suite(name)
    facts = [
        ("is", "a suite"),
        ("scenarios", ", ".join(s.identity for s in suite.scenarios)),
        ("tracks", ", ".join(suite.tracks)),
        ("navigators", ", ".join(e.label for e in suite.entries)),
        ("seeds", f"{suite.seeds.start} … {suite.seeds.stop - 1} of split {suite.split}"),
    ]
    yield f"{suite.name}@{suite.version}\n" + columns([("  " + k, v) for k, v in facts])


def _everything() -> list[str]:
    from benchnav.runner.suite_file import suite_names
    from benchnav.scenario.catalogue import names

    plugins = [name for registry in REGISTRIES.values() for name in registry.names()]
    return [*plugins, *names(), *suite_names()]
