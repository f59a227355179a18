"""`benchnav import recording`: convert recordings of people into scenario files."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.authoring.import_options import (
    Force,
    Name,
    Numbers,
    import_file,
    numbers,
)


def recording(
    recording: Annotated[Path, typer.Argument(metavar="RECORDING", help="A recording of people.")],
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
        Numbers | None,
        typer.Option(
            parser=numbers("--wall-origin"),
            metavar="X,Y",
            help="Lower left corner [m] of an image of walls.",
        ),
    ] = None,
    wall_negate: Annotated[
        bool, typer.Option("--wall-negate", help="Light pixels of an image are walls.")
    ] = False,
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
    import_file(
        "import_recording",
        {**locals(), "columns": None if columns is None else columns.split(",")},
    )
