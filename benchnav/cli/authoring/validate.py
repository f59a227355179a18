"""`benchnav validate`: check a scenario or suite file."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.api.components.scenario_page import worlds_text
from benchnav.cli.console import put
from benchnav.text.plural import counted


def validate(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A scenario or suite file.")],
    draw: Annotated[
        bool,
        typer.Option(help="Also draw worlds of a scenario: are they solvable, do they differ?"),
    ] = True,
) -> None:
    """Check a scenario or suite file.

    Each problem is reported as file:line: key.
    """
    from benchnav.config.yaml_reader import read_yaml
    from benchnav.runner.plan.suite_file import describes_scenario

    if describes_scenario(read_yaml(file).data):
        _scenario(file, draw)
    else:
        _suite(file)


def _suite(file: Path) -> None:
    from benchnav.runner.plan.suite import load_suite

    suite = load_suite(str(file))
    cells = list(suite.cells())
    missing = sum(bool(cell.reason) for cell in cells)
    put(
        f"{file} is a suite, {suite.name}@{suite.version}: {counted(len(cells), 'cell')},"
        f" {missing} of them n/a, × {counted(len(suite.seeds), 'seed')}"
    )


def _scenario(file: Path, draw: bool) -> None:
    from benchnav.navigation.plugin.background_navigators import check_drivers
    from benchnav.scenario.load import load_scenario

    scenario = load_scenario(file)
    check_drivers(scenario)
    put(f"{file} is a scenario, {scenario.identity}, hash {scenario.hash}")
    if not draw:
        return
    from benchnav.generation.build import build

    world = build(scenario, "test", 0)
    put(
        f"its first test world has {counted(len(world.agents), 'agent')}; walls and static"
        f" obstacles: {len(world.solids)}, moving ones: {len(world.bodies)}; draws before it that"
        f" were not solvable: {world.redraws}"
    )
    put(f"its worlds {worlds_text(scenario)}")
