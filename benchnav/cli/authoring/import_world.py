"""`benchnav import sdf`, `mesh`, `wkt`, `image`: worlds of other programs as scenarios."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.authoring.import_options import (
    Agents,
    Band,
    Bounds,
    Force,
    Goal,
    Margin,
    Name,
    Numbers,
    Out,
    Radius,
    Start,
    Unit,
    import_file,
    numbers,
)


def sdf(
    file: Annotated[Path, typer.Argument(metavar="WORLD", help="An SDF world or model.")],
    out: Out,
    models: Annotated[
        list[Path] | None, typer.Option(metavar="DIR", help="Folder of models. Repeatable.")
    ] = None,
    skip_missing: Annotated[
        bool, typer.Option("--skip-missing", help="Leave out models and meshes not found.")
    ] = False,
    unit: Unit = None,
    up: Annotated[
        str | None,
        typer.Option(metavar="AXIS", help="Vertical axis of meshes. [default: z, as in Gazebo]"),
    ] = None,
    scale: Annotated[
        float | None, typer.Option(help="Factor of meshes, beside that of the world.")
    ] = None,
    band: Band = None,
    bounds: Bounds = None,
    margin: Margin = None,
    start: Start = None,
    goal: Goal = None,
    agents: Agents = None,
    radius: Radius = None,
    name: Name = None,
    force: Force = False,
) -> None:
    """Convert an SDF world or model of Gazebo: its collision shapes are walls."""
    import_file("import_world", locals(), format="sdf")


def mesh(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="A COLLADA, STL, OBJ, PLY or OFF file.")
    ],
    out: Out,
    unit: Unit = None,
    up: Annotated[
        str | None,
        typer.Option(metavar="AXIS", help="Vertical axis. [default: as the file declares, else z]"),
    ] = None,
    scale: Annotated[
        Numbers | None,
        typer.Option(
            parser=numbers("--scale"), metavar="S[,S,S]", help="Factor, or factors along x, y, z."
        ),
    ] = None,
    band: Band = None,
    bounds: Bounds = None,
    margin: Margin = None,
    start: Start = None,
    goal: Goal = None,
    agents: Agents = None,
    radius: Radius = None,
    name: Name = None,
    force: Force = False,
) -> None:
    """Convert a mesh: its part within the agents' band of heights is a wall."""
    import_file("import_world", locals(), format="mesh")


def wkt(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A file with a WKT geometry.")],
    out: Out,
    obstacles: Annotated[
        bool,
        typer.Option("--obstacles", help="The polygons are obstacles, not the walkable area."),
    ] = False,
    unit: Unit = None,
    bounds: Bounds = None,
    margin: Margin = None,
    start: Start = None,
    goal: Goal = None,
    agents: Agents = None,
    radius: Radius = None,
    name: Name = None,
    force: Force = False,
) -> None:
    """Convert a walkable area of JuPedSim or PedPy, written as WKT."""
    import_file("import_world", locals(), format="wkt")


def image(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="A picture: PNG, PGM, BMP, JPEG, GIF or TIFF.")
    ],
    out: Out,
    resolution: Annotated[float, typer.Option(metavar="M", help="Metres per pixel.")],
    threshold: Annotated[
        float | None,
        typer.Option(help="Darkness of obstacles, 0 (white) to 1 (black). [default: 0.5]"),
    ] = None,
    negate: Annotated[bool, typer.Option("--negate", help="Light pixels are obstacles.")] = False,
    origin: Annotated[
        Numbers | None,
        typer.Option(
            parser=numbers("--origin"), metavar="X,Y", help="Lower left corner [m]. [default: 0,0]"
        ),
    ] = None,
    agents: Agents = None,
    radius: Radius = None,
    name: Name = None,
    force: Force = False,
) -> None:
    """Convert a picture: dark pixels are walls."""
    import_file("import_world", locals(), format="image")
