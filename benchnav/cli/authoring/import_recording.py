"""`benchnav import recording`: convert recordings of people into scenario files."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.authoring.import_map import Force, Name
from benchnav.cli.console import put
from benchnav.cli.stopping import stoppable
from benchnav.errors import UsageError


@stoppable
def recording(
    file: Annotated[Path, typer.Argument(metavar="RECORDING", help="A recording of people.")],
    out: Annotated[Path, typer.Option(metavar="FILE", help="Scenario file to write.")],
    format: Annotated[
        str | None,
        typer.Option(
            metavar="FORMAT",
            help="eth, text, trajnetpp, juelich, hdf5, jupedsim, vadere, viswalk, crowdit,"
            " pathfinder-csv, pathfinder-json, or pedpy for one of PedPy's formats."
            " [default: by suffix and content]",
        ),
    ] = None,
    rate: Annotated[
        float | None,
        typer.Option(metavar="HZ", help="Frames per second. [default: the file's own]"),
    ] = None,
    unit: Annotated[
        str | None,
        typer.Option(
            metavar="UNIT",
            help="m, cm, mm, ft, in, or metres per unit. [default: the file's own, or m]",
        ),
    ] = None,
    columns: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES",
            help="Columns of a text file, such as frame,id,x,_,y. [default: by its header]",
        ),
    ] = None,
    gaps: Annotated[
        str, typer.Option(metavar="HOW", help="Gaps in tracks: refuse, split or bridge.")
    ] = "refuse",
    replace: Annotated[
        str,
        typer.Option(
            metavar="ID", help="Person that the robot replaces: an id, random (by seed) or none."
        ),
    ] = "random",
    react: Annotated[
        str | None,
        typer.Option(
            metavar="NAVIGATOR",
            help="Navigator that moves the other people. [default: they follow the recording]",
        ),
    ] = None,
    walls: Annotated[
        str | None,
        typer.Option(
            metavar="WALLS",
            help="none, hull, or a file: WKT, ROS map, image, Vadere scenario, Crowd:it geometry."
            " [default: the recording's own, or none]",
        ),
    ] = None,
    wall_cell: Annotated[
        float | None, typer.Option(metavar="M", help="Metres per pixel of an image of walls.")
    ] = None,
    wall_origin: Annotated[
        str | None,
        typer.Option(metavar="X,Y", help="Lower left corner [m] of an image of walls."),
    ] = None,
    person_radius: Annotated[
        float, typer.Option(metavar="M", help="Radius [m] of a person.")
    ] = 0.2,
    radius: Annotated[
        float | None,
        typer.Option(metavar="M", help="Radius [m] of the robot. [default: that of a person]"),
    ] = None,
    speed: Annotated[
        float, typer.Option(metavar="V", help="Largest speed [m/s] of the robot.")
    ] = 1.5,
    horizon: Annotated[
        float | None,
        typer.Option(
            metavar="S", help="Time limit [s]. [default: twice the longest track, 20 to 300]"
        ),
    ] = None,
    name: Name = None,
    force: Force = False,
) -> None:
    """Convert a recording of people; the robot replaces one of them."""
    from benchnav.api.authoring.import_recording import import_recording

    files = import_recording(
        file, out, format=format, rate=rate, unit=unit,
        columns=None if columns is None else columns.split(","), gaps=gaps,  # type: ignore[arg-type] # checked there
        replace=replace, react=react, walls=walls, wall_cell=wall_cell,
        wall_origin=_origin(wall_origin), person_radius=person_radius, radius=radius, speed=speed,
        horizon=horizon, name=name, force=force,
    )  # fmt: skip
    put("\n".join(str(file) for file in files))


def _origin(text: str | None) -> tuple[float, float] | None:
    if text is None:
        return None
    try:
        x, y = map(float, text.split(","))
    except ValueError:
        raise UsageError(f"--wall-origin must be two numbers, X,Y; got {text!r}.") from None
    return x, y
