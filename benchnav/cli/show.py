"""`benchnav show`: one thing by name, with its parameters, units and source."""

import inspect
from collections.abc import Iterator
from typing import Annotated, Any

import typer

from benchnav.cli.console import columns, put
from benchnav.cli.listing import REGISTRIES, Kind, sentence
from benchnav.cli.scenario_page import scenario_page
from benchnav.errors import UsageError, did_you_mean
from benchnav.plugins import Registry


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
        if name in registry.names() or (kind == Kind.NAVIGATORS and _is_class(name))
    ]
    blocks += [*_scenario(name), *_suite(name)]
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
    needs = getattr(thing, "needs", None)
    if isinstance(needs, frozenset):
        facts.append(("needs", ", ".join(sorted(needs)) or "nothing beyond its own state and goal"))
    if isinstance(getattr(thing, "command", None), str):
        facts.append(("answers", f"a {thing.command} per agent"))
    text = f"{name}\n" + columns([("  " + key, value) for key, value in facts])
    return f"{text}\n  parameters\n{_parameters(thing)}" if hasattr(thing, "Config") else text


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


def _parameters(plugin: Any) -> str:
    rows = [
        ("    " + key, _type(field.annotation), _default(field), field.description or "")
        for key, field in plugin.Config.model_fields.items()
    ]
    return columns(rows) if rows else "    none"


def _type(annotation: Any) -> str:
    if isinstance(annotation, type):
        return annotation.__name__
    return str(annotation).replace("typing.", "").replace("NoneType", "None")


def _default(field: Any) -> str:
    if field.is_required():
        return "must be given"
    return f"= {field.get_default(call_default_factory=True)!r}"


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
