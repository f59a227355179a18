"""`benchnav score`: metrics of trajectories that other programs recorded or simulated."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import deliver, put
from benchnav.cli.output_format import out_format
from benchnav.cli.tables.leaderboard import FORMATS as TABLE_FORMATS
from benchnav.errors import UsageError


def score(
    files: Annotated[list[Path], typer.Argument(metavar="FILE…", help="Tables of trajectories.")],
    format: Annotated[
        str | None,
        typer.Option(
            help="csv, parquet, or that of a recording: eth, text, trajnetpp, juelich, hdf5,"
            " jupedsim, vadere, viswalk, crowdit, pathfinder-csv, pathfinder-json, or pedpy for one"
            " of PedPy's formats. [default: by suffix and content]"
        ),
    ] = None,
    scenario: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME|FILE",
            help="Scenario with walls, rules and goals. Repeatable, for a table of several.",
        ),
    ] = None,
    seed: Annotated[int, typer.Option(metavar="N", help="Seed of the scenario's world.")] = 0,
    track: Annotated[str, typer.Option(help="The knowledge track.")] = "known",
    perception: Annotated[str, typer.Option(help="The perception: exact or noisy.")] = "exact",
    label: Annotated[
        str | None, typer.Option(metavar="NAME", help="Name in the table. [default: the file's]")
    ] = None,
    rate: Annotated[
        float | None, typer.Option(metavar="HZ", help="Frames a second, if the file has frames.")
    ] = None,
    unit: Annotated[
        float | None, typer.Option(metavar="M", help="Metres per unit of length. [default: 1]")
    ] = None,
    step: Annotated[
        float | None,
        typer.Option(metavar="S", help="Interpolate the tracks at multiples of this time [s]."),
    ] = None,
    gaps: Annotated[
        str, typer.Option(help="An id that is missing for a time: refuse, bridge or split.")
    ] = "refuse",
    column: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=COLUMN", help="The file's name of a column. Repeatable."),
    ] = None,
    radius: Annotated[
        float | None, typer.Option(metavar="M", help="Radius of all ids [m].")
    ] = None,
    preferred_speed: Annotated[
        float | None, typer.Option(metavar="M/S", help="Preferred speed of all ids [m/s].")
    ] = None,
    goals: Annotated[
        str, typer.Option(help="columns (goal_x, goal_y), or last: the last position of an id.")
    ] = "columns",
    goal_tolerance: Annotated[
        float | None,
        typer.Option(metavar="M", help="[default: the scenario's, else 0.3; 0 for --goals last]"),
    ] = None,
    area: Annotated[
        str | None,
        typer.Option(metavar="X0,Y0,X1,Y1", help="Measurement area [m] of densities and flow."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="Write the table to this file, .md, .csv, .tex, .html or .json."),
    ] = None,
    table: Annotated[
        str | None,
        typer.Option(metavar="FORMAT", help="terminal, markdown, csv, latex, html or json."),
    ] = None,
    metric: Annotated[
        list[str] | None, typer.Option(help="Show this metric. Repeatable. [default: all]")
    ] = None,
) -> None:
    """Measure trajectories that other programs recorded or simulated.

    A metric that needs what the file does not hold is n/a, with the reason.
    """
    from benchnav.api.execution.score import score as scored

    if table is None and out is None and sys.stdout.isatty():
        table = "terminal"
    wanted = out_format(TABLE_FORMATS, table, out)
    found = scored(
        files, format=format, scenario=scenario or (), seed=seed, track=track,
        perception=perception, label=label, rate=rate, unit=unit, step=step, gaps=gaps,
        columns=_columns(column or []),
        radius=radius, preferred_speed=preferred_speed, goals=goals, goal_tolerance=goal_tolerance,
        area=_area(area), metrics=metric,
    )  # fmt: skip
    text = found.text(wanted)
    if wanted == "terminal" and out is None:
        put(text.rstrip("\n"), safe=True)
    else:
        deliver(text, out)


def _columns(pairs: list[str]) -> dict[str, str]:
    found = {}
    for pair in pairs:
        name, equals, column = pair.partition("=")
        if not (name and equals and column):
            raise UsageError(
                f"--column must be NAME=COLUMN, such as x=pos_x. Got {pair!r} instead."
            )
        found[name] = column
    return found


def _area(text: str | None) -> list[float] | None:
    if text is None:
        return None
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise UsageError(
            f"--area must be X0,Y0,X1,Y1 in metres, such as 0,0,4,4. Got {text!r} instead."
        ) from None
