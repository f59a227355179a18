"""One entry for each installed component of a kind, and for each that is broken."""

from collections.abc import Iterator
from typing import NamedTuple

from benchnav.api.components.kind import REGISTRIES, Kind
from benchnav.errors import BenchnavError
from benchnav.plugins import ROBOTS, SCENARIOS, SUITES, Registry

BROKEN = "broken"


class Entry(NamedTuple):
    """A component. If it is broken, its description is the reason."""

    name: str
    origin: str  # distribution, version or trainer; BROKEN if it cannot be used
    description: str


def names(kind: Kind) -> list[str]:
    """Return the names of a kind, sorted, without reading the components."""
    if kind in REGISTRIES:
        return REGISTRIES[kind].names()
    if kind == Kind.RECIPES:
        from benchnav.envs.recipes import recipe_files

        return list(recipe_files()[0])
    if kind == Kind.ROBOTS:
        from benchnav.scenario.robots import registry

        return registry.names()
    if kind == Kind.SUITES:
        from benchnav.runner.plan.suite_file import suite_names

        return suite_names()
    from benchnav.scenario import catalogue

    return catalogue.names()


def entries(kind: Kind) -> Iterator[Entry]:
    """Yield the entries of a kind. Plugins of other packages are loaded in other processes."""
    if kind == Kind.SCENARIOS:
        yield from _scenarios()
    elif kind == Kind.ROBOTS:
        yield from _robots()
    elif kind == Kind.SUITES:
        yield from _suites()
    elif kind == Kind.RECIPES:
        yield from _recipes()
    else:
        yield from _plugins(REGISTRIES[kind])


def _plugins(registry: Registry) -> Iterator[Entry]:
    from benchnav.api.components.inspection import SENTENCE, inspect_plugins

    for name, text in inspect_plugins(registry, registry.names(), SENTENCE).items():
        if isinstance(text, BenchnavError):
            yield Entry(name, BROKEN, str(text))
        else:
            yield Entry(name, registry.source(name).distribution, text)


def _scenarios() -> Iterator[Entry]:
    from benchnav.config.yaml_packages import missing_packages, scenario_files
    from benchnav.scenario.catalogue import find

    for name, files in scenario_files().items():
        try:
            found = find(name)
            yield Entry(name, _origin(found.version, files[0].distribution), found.title)
        except BenchnavError as error:
            yield Entry(name, BROKEN, str(error))
    for package, cause in missing_packages(SCENARIOS):
        yield Entry(package, BROKEN, cause)


def _robots() -> Iterator[Entry]:
    from benchnav.config.yaml_packages import missing_packages
    from benchnav.scenario.robots import registry

    for name in registry.names():
        try:
            yield Entry(name, registry.origin(name), registry.find_robot(name).title)
        except BenchnavError as error:
            yield Entry(name, BROKEN, str(error))
    for package, cause in missing_packages(ROBOTS):
        yield Entry(package, BROKEN, cause)


def _suites() -> Iterator[Entry]:
    from benchnav.config.yaml_packages import missing_packages, suite_files
    from benchnav.config.yaml_reader import read_yaml, validate
    from benchnav.runner.plan.suite_file import SuiteFile, suite_path

    for name, files in suite_files().items():
        try:
            suite = validate(SuiteFile, read_yaml(suite_path(name)))
            yield Entry(name, _origin(suite.version, files[0].distribution), suite.description)
        except BenchnavError as error:
            yield Entry(name, BROKEN, str(error))
    for package, cause in missing_packages(SUITES):
        yield Entry(package, BROKEN, cause)


def _origin(version: int, distribution: str) -> str:
    return f"version {version}, {distribution}"


def _recipes() -> Iterator[Entry]:
    from benchnav.envs.recipes import recipe_files

    found, broken = recipe_files()
    for name, recipe in found.items():
        try:
            yield Entry(name, f"trainer {recipe.trainer}", recipe.description)
        except BenchnavError as error:
            yield Entry(name, BROKEN, str(error))
    for trainer, cause in broken.items():
        yield Entry(f"(of {trainer})", BROKEN, str(cause))
