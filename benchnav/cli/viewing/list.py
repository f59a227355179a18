"""`benchnav list`: what is installed, and what of it is broken."""

from collections.abc import Iterator
from enum import StrEnum
from typing import Annotated

import typer

from benchnav.cli.console import columns, one_of, put
from benchnav.errors import BenchnavError
from benchnav.plugins import CONTROLLERS, METRICS, NAVIGATORS, PLANNERS, Registry


class Kind(StrEnum):
    """What can be listed."""

    NAVIGATORS = "navigators"
    PLANNERS = "planners"
    CONTROLLERS = "controllers"
    SCENARIOS = "scenarios"
    SUITES = "suites"
    METRICS = "metrics"


REGISTRIES = {
    Kind.NAVIGATORS: NAVIGATORS,
    Kind.PLANNERS: PLANNERS,
    Kind.CONTROLLERS: CONTROLLERS,
    Kind.METRICS: METRICS,
}

Row = tuple[str, str, str]  # name, where from, what it is


def list_(
    kind: Annotated[
        str | None,
        typer.Argument(
            metavar="KIND",
            help="navigators, planners, controllers, scenarios, suites or metrics. [default: all]",
        ),
    ] = None,
) -> None:
    """List what can be named, and what is broken."""
    if kind is not None:
        put(columns(list(_rows(one_of(Kind, "KIND", kind)))))
        return
    for number, each in enumerate(Kind):
        put(f"{'' if number == 0 else chr(10)}{each.value}")
        put(columns([("  " + name, *rest) for name, *rest in _rows(each)]))


def _rows(kind: Kind) -> Iterator[Row]:
    if kind == Kind.SCENARIOS:
        yield from _scenarios()
    elif kind == Kind.SUITES:
        yield from _suites()
    else:
        yield from _plugins(REGISTRIES[kind])


def _plugins(registry: Registry) -> Iterator[Row]:
    from benchnav.cli.viewing.inspection import SENTENCE, inspect_plugins

    for name, text in inspect_plugins(registry, registry.names(), SENTENCE).items():
        if isinstance(text, BenchnavError):
            yield name, "broken", str(text)
        else:
            yield name, registry.source(name).distribution, text


def _scenarios() -> Iterator[Row]:
    from benchnav.scenario.catalogue import find, names

    for name in names():
        try:
            found = find(name)
            yield name, f"version {found.version}", found.title
        except BenchnavError as error:
            yield name, "broken", str(error)


def _suites() -> Iterator[Row]:
    from benchnav.config.yaml_reader import read_yaml, validate
    from benchnav.runner.plan.suite_file import SuiteFile, suite_names, suite_path

    for name in suite_names():
        try:
            said = validate(SuiteFile, read_yaml(suite_path(name)))
            yield name, f"version {said.version}", said.description
        except BenchnavError as error:
            yield name, "broken", str(error)
