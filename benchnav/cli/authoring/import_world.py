"""`benchnav import sdf`, `mesh`, `wkt`, `image`: worlds of other programs as scenarios."""

from pathlib import Path
from typing import Annotated, Any

import typer

from benchnav.cli.authoring.import_map import Agents, Force, Name, Out, import_app
from benchnav.cli.console import put
from benchnav.cli.stopping import stoppable
from benchnav.errors import UsageError

__all__ = ["import_app"]

Radius = Annotated[float | None, typer.Option(metavar="M", help="Agent radius [m]. [default: 0.2]")]
Bounds = Annotated[
    str | None,
    typer.Option(
        metavar="X0,Y0,X1,Y1", help="Edges of the arena [m]. [default: around the obstacles]"
    ),
]
Margin = Annotated[
    float | None,
    typer.Option(metavar="M", help="Space [m] around obstacles, start, goal. [default: 1]"),
]
Start = Annotated[
    str | None, typer.Option(metavar="X,Y", help="Start [m] of one agent. [default: drawn]")
]
Goal = Annotated[str | None, typer.Option(metavar="X,Y", help="Goal [m] of that agent.")]
Unit = Annotated[
    float | None,
    typer.Option(metavar="M", help="Metres per unit. [default: as the file declares, else 1]"),
]
Band = Annotated[
    str | None,
    typer.Option(metavar="LOW,HIGH", help="Heights [m] of obstacles. [default: 0.05,2]"),
]


@import_app.command("sdf")
@stoppable
def sdf(
    world: Annotated[Path, typer.Argument(metavar="WORLD", help="An SDF world or model.")],
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
    _import(
        world, out, "sdf", models=models or (), skip_missing=skip_missing, unit=unit, up=up,
        scale=scale, band=_numbers("--band", band), bounds=_numbers("--bounds", bounds),
        margin=margin, start=_numbers("--start", start), goal=_numbers("--goal", goal),
        agents=agents, radius=radius, name=name, force=force,
    )  # fmt: skip


@import_app.command("mesh")
@stoppable
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
        str | None, typer.Option(metavar="S[,S,S]", help="Factor, or factors along x, y, z.")
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
    _import(
        file, out, "mesh", unit=unit, up=up, scale=_numbers("--scale", scale),
        band=_numbers("--band", band), bounds=_numbers("--bounds", bounds), margin=margin,
        start=_numbers("--start", start), goal=_numbers("--goal", goal), agents=agents,
        radius=radius, name=name, force=force,
    )  # fmt: skip


@import_app.command("wkt")
@stoppable
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
    _import(
        file, out, "wkt", obstacles=obstacles, unit=unit, bounds=_numbers("--bounds", bounds),
        margin=margin, start=_numbers("--start", start), goal=_numbers("--goal", goal),
        agents=agents, radius=radius, name=name, force=force,
    )  # fmt: skip


@import_app.command("image")
@stoppable
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
        str | None, typer.Option(metavar="X,Y", help="Lower left corner [m]. [default: 0,0]")
    ] = None,
    agents: Agents = None,
    radius: Radius = None,
    name: Name = None,
    force: Force = False,
) -> None:
    """Convert a picture: dark pixels are walls."""
    _import(
        file, out, "image", resolution=resolution, threshold=threshold, negate=negate,
        origin=_numbers("--origin", origin), agents=agents, radius=radius, name=name, force=force,
    )  # fmt: skip


def _import(file: Path, out: Path, format: str, **options: Any) -> None:
    from benchnav.api.authoring.import_world import import_world

    put("\n".join(str(path) for path in import_world(file, out, format=format, **options)))


def _numbers(option: str, text: str | None) -> list[float] | None:
    if text is None:
        return None
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise UsageError(
            f"{option} must be numbers with commas between them, such as 1,2.5. Got {text!r}."
        ) from None
