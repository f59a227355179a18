"""`benchnav list`: all installed components, and the broken ones."""

from collections.abc import Iterator
from enum import StrEnum
from typing import Annotated

import typer

from benchnav.cli.console import one_of, put
from benchnav.errors import BenchnavError
from benchnav.plugins import (
    CONTROLLERS,
    METRICS,
    NAVIGATORS,
    PLANNERS,
    SCENARIOS,
    SUITES,
    TRAINERS,
    Registry,
)
from benchnav.text.columns import columns


class Kind(StrEnum):
    """The kinds that can be listed."""

    NAVIGATORS = "navigators"
    PLANNERS = "planners"
    CONTROLLERS = "controllers"
    SCENARIOS = "scenarios"
    SUITES = "suites"
    METRICS = "metrics"
    TRAINERS = "trainers"
    RECIPES = "recipes"


REGISTRIES = {
    Kind.NAVIGATORS: NAVIGATORS,
    Kind.PLANNERS: PLANNERS,
    Kind.CONTROLLERS: CONTROLLERS,
    Kind.METRICS: METRICS,
    Kind.TRAINERS: TRAINERS,
}

Row = tuple[str, str, str]  # name, origin, description


def list_(
    kind: Annotated[
        str | None,
        typer.Argument(
            metavar="KIND",
            help="navigators, planners, controllers, scenarios, suites, metrics, trainers or"
            " recipes. [default: all]",
        ),
    ] = None,
) -> None:
    """List the names of all components, and the broken ones."""
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
    elif kind == Kind.RECIPES:
        yield from _recipes()
    else:
        yield from _plugins(REGISTRIES[kind])


def _plugins(registry: Registry) -> Iterator[Row]:
    from benchnav.api.components.inspection import SENTENCE, inspect_plugins

    for name, text in inspect_plugins(registry, registry.names(), SENTENCE).items():
        if isinstance(text, BenchnavError):
            yield name, "broken", str(text)
        else:
            yield name, registry.source(name).distribution, text


def _scenarios() -> Iterator[Row]:
    from benchnav.config.yaml_packages import missing_packages, scenario_files
    from benchnav.scenario.catalogue import find

    for name, files in scenario_files().items():
        try:
            found = find(name)
            yield name, _origin(found.version, files[0].distribution), found.title
        except BenchnavError as error:
            yield name, "broken", str(error)
    for package, cause in missing_packages(SCENARIOS):
        yield package, "broken", cause


def _suites() -> Iterator[Row]:
    from benchnav.config.yaml_packages import missing_packages, suite_files
    from benchnav.config.yaml_reader import read_yaml, validate
    from benchnav.runner.plan.suite_file import SuiteFile, suite_path

    for name, files in suite_files().items():
        try:
            suite = validate(SuiteFile, read_yaml(suite_path(name)))
            yield name, _origin(suite.version, files[0].distribution), suite.description
        except BenchnavError as error:
            yield name, "broken", str(error)
    for package, cause in missing_packages(SUITES):
        yield package, "broken", cause


def _origin(version: int, distribution: str) -> str:
    return f"version {version}, {distribution}"


def _recipes() -> Iterator[Row]:
    from benchnav.envs.recipes import recipe_files

    found, broken = recipe_files()
    for name, recipe in found.items():
        try:
            yield name, f"trainer {recipe.trainer}", recipe.description
        except BenchnavError as error:
            yield name, "broken", str(error)
    for trainer, cause in broken.items():
        yield f"(of {trainer})", "broken", str(cause)
