"""Check a scenario, suite or robot before it is used."""

from collections.abc import Iterator, Mapping
from html import escape
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchnav.api.components.scenario_page import worlds_text
from benchnav.api.execution.suite_source import suite_source
from benchnav.config.yaml_packages import SUFFIXES
from benchnav.config.yaml_reader import document_of, read_yaml
from benchnav.errors import BenchnavError, UsageError, did_you_mean
from benchnav.processes.main_module import stop_import_of_main
from benchnav.text.plural import counted

if TYPE_CHECKING:
    from benchnav.config.document import Document
    from benchnav.scenario.scenario import Scenario

Checkable = str | PathLike[str] | Mapping[str, Any]
"""A YAML file, its content, or the name of an installed scenario, suite or robot."""


class Validation:
    """The result of a check of a file; true in a condition if it has no problems."""

    def __init__(self, facts: str, error: BenchnavError | None) -> None:
        self.facts = facts  # what was found, in sentences
        self.error = error  # which running it would raise; None: it can be run

    @property
    def valid(self) -> bool:
        """Whether it has no problems."""
        return self.error is None

    @property
    def problems(self) -> list[str]:
        """The problems, one a line: file:line: key, and what it must be."""
        return [] if self.error is None else str(self.error).splitlines()

    def text(self) -> str:
        """Return the facts and the problems, as ``benchnav validate`` prints them."""
        return "\n".join([*self.facts.splitlines(), *self.problems])

    def __bool__(self) -> bool:
        return self.valid

    def __repr__(self) -> str:
        return self.text()

    def _repr_html_(self) -> str:
        return f"<pre>{escape(self.text())}</pre>"


def validate(content: Checkable, *, draw: bool = True) -> Validation:
    """Check a scenario, suite or robot, and return its problems.

    Args:
        content: a YAML file, its content as a dict, as `benchnav.run` takes it, or the name of an
            installed scenario, suite or robot. A scenario may have parameters:
            ``NAME:key=value``, ``FILE:key=value``. Files that a dict names are relative to the
            working directory.
        draw: also draw worlds of a scenario: are they solvable, do they differ?
    """
    stop_import_of_main()
    facts: list[str] = []
    try:
        for fact in _facts(content, draw):
            facts.append(fact)  # noqa: PERF402 - what came before an error counts
    except BenchnavError as error:
        return Validation("\n".join(facts), error)
    return Validation("\n".join(facts), None)


def _facts(content: Checkable, draw: bool) -> Iterator[str]:
    from benchnav.runner.plan.suite_file import describes_scenario
    from benchnav.scenario.load import scenario_of
    from benchnav.scenario.parameters import split_parameters
    from benchnav.scenario.robots.robot import is_robot

    if isinstance(content, Mapping):
        if is_robot(content):
            yield _robot(document_of(content, "robot"), "It")
        elif describes_scenario(dict(content)):
            yield from _scenario(scenario_of(document_of(content, "scenario"), Path()), draw, "It")
        else:
            yield _suite(suite_source(content), "It")
        return
    base, parameters = split_parameters(str(content))
    if parameters or not (base.endswith(SUFFIXES) or Path(base).exists()):
        yield from _named(str(content), draw)
        return
    document = read_yaml(Path(content))
    if is_robot(document.data):
        yield _robot(document, str(content))
    elif describes_scenario(document.data):
        yield from _scenario(scenario_of(document, Path(content).parent), draw, str(content))
    else:
        yield _suite(str(content), str(content))


def _robot(document: "Document", name: str) -> str:
    from benchnav.scenario.robots.robot import ESTIMATE, robot_of

    robot = robot_of(document)
    published = [s for s in robot.sources.values() if not s.startswith(ESTIMATE)]
    return (
        f"{name} is a robot, {robot.title}: {counted(len(robot.keys), 'key')} of a team,"
        f" {len(published)} with a published source"
    )


def _suite(source: "str | Document", name: str) -> str:
    from benchnav.runner.plan.suite import load_suite

    suite = load_suite(source)
    jobs = list(suite.jobs())
    missing = sum(bool(job.reason) for job in jobs)
    return (
        f"{name} is a suite, {suite.name}@{suite.version}: {counted(len(jobs), 'cell')},"
        f" {missing} of them n/a, × {counted(len(suite.seeds), 'seed')}"
    )


def _named(name: str, draw: bool) -> Iterator[str]:
    """Yield facts of an installed scenario, suite or robot, or of a file with parameters."""
    from benchnav.runner.plan.suite_file import suite_names
    from benchnav.scenario import catalogue
    from benchnav.scenario.robots import registry

    if catalogue.is_named(name):
        yield from _scenario(catalogue.find(name), draw, name)
    elif name in suite_names():
        yield _suite(name, name)
    elif name in registry.names():
        yield f"{name} is a robot, {registry.find_robot(name).title}"
    else:
        known = [*catalogue.names(), *suite_names(), *registry.names()]
        raise UsageError(
            f"{name} must be a file (.yaml), or an installed scenario, suite or robot."
            f"{did_you_mean(name.partition(':')[0], known)} 'benchnav list' shows all."
        )


def _scenario(scenario: "Scenario", draw: bool, name: str) -> Iterator[str]:
    from benchnav.navigation.plugin.background_navigators import check_drivers

    check_drivers(scenario)
    yield f"{name} is a scenario, {scenario.identity}, hash {scenario.hash}"
    if draw:
        yield from _worlds(scenario)


def _worlds(scenario: "Scenario") -> Iterator[str]:
    from benchnav.generation.build import build

    world = build(scenario, "test", 0)
    yield (
        f"its first test world has {counted(len(world.agents), 'agent')}; walls and static"
        f" obstacles: {len(world.solids)}, moving ones: {len(world.bodies)}; draws before it that"
        f" were not solvable: {world.redraws}"
    )
    yield f"its worlds {worlds_text(scenario)}"
