"""Options that the commands of `benchnav import` share, and the call of the Python function."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from benchnav.cli.console import put
from benchnav.errors import UsageError


class Numbers(tuple[float, ...]):
    """Numbers with commas between them."""

    __slots__ = ()


def numbers(option: str) -> Callable[[str], Numbers]:
    """Return a parser of `Numbers` for an option. It raises UsageError."""

    def parsed(text: str) -> Numbers:
        try:
            return Numbers(float(part) for part in text.split(","))
        except ValueError:
            raise UsageError(
                f"{option} must be numbers with commas between them, such as 1,2.5. Got {text!r}."
            ) from None

    return parsed


Out = Annotated[
    Path,
    typer.Option(metavar="FILE", help="Scenario file to write; the map is copied beside it."),
]
Agents = Annotated[
    int | None,
    typer.Option(metavar="N", help="Number of agents. [default: 20, or fewer in a small map]"),
]
Name = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="Scenario name. [default: from FILE, map or its folder]"),
]
Force = Annotated[
    bool, typer.Option("--force", help="Overwrite the scenario file; a map is never overwritten.")
]
Radius = Annotated[
    float | None,
    typer.Option(metavar="M", help="Agent radius [m]. [default: 0.2, or less on a small map]"),
]
Bounds = Annotated[
    Numbers | None,
    typer.Option(
        parser=numbers("--bounds"), metavar="X0,Y0,X1,Y1",
        help="Edges of the arena [m]. [default: around the obstacles]",
    ),
]  # fmt: skip
Margin = Annotated[
    float | None,
    typer.Option(metavar="M", help="Space [m] around obstacles, start, goal. [default: 1]"),
]
Start = Annotated[
    Numbers | None,
    typer.Option(
        parser=numbers("--start"), metavar="X,Y", help="Start [m] of one agent. [default: drawn]"
    ),
]
Goal = Annotated[
    Numbers | None,
    typer.Option(parser=numbers("--goal"), metavar="X,Y", help="Goal [m] of that agent."),
]
Unit = Annotated[
    float | None,
    typer.Option(metavar="M", help="Metres per unit. [default: as the file declares, else 1]"),
]
Band = Annotated[
    Numbers | None,
    typer.Option(
        parser=numbers("--band"), metavar="LOW,HIGH",
        help="Heights [m] of obstacles. [default: 0.05,2]",
    ),
]  # fmt: skip


def import_file(function: str, options: Mapping[str, Any], **more: Any) -> None:
    """Call a function of the Python API and print the files that it wrote.

    ``options`` are the arguments of a command (``locals()``), which have the names of those of the
    function. Those that are None are left to their defaults.
    """
    import benchnav

    given = {name: value for name, value in options.items() if value is not None}
    files = getattr(benchnav, function)(**given, **more)
    put("\n".join(str(file) for file in files))
