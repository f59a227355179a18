"""`benchnav import movingai` and `ros-map`: maps of other projects as scenarios."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.authoring.import_options import (
    Agents,
    Force,
    Name,
    Out,
    Radius,
    import_file,
)


def movingai(
    map: Annotated[Path, typer.Argument(metavar="MAP", help="A .map file.")],
    out: Out,
    scen: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Starts and goals from this .scen file, spread over its buckets. [default: drawn]",
        ),
    ] = None,
    agents: Agents = None,
    bucket: Annotated[
        int | None, typer.Option(metavar="N", help="Only queries of this bucket of the .scen file.")
    ] = None,
    cell: Annotated[float, typer.Option(metavar="M", help="Side of a cell [m].")] = 1.0,
    radius: Annotated[
        float | None, typer.Option(metavar="M", help="Agent radius [m]. [default: 0.3 cells]")
    ] = None,
    name: Name = None,
    force: Force = False,
) -> None:
    """Convert a grid map of the MovingAI benchmarks."""
    import_file("import_map", locals(), format="movingai")


def ros_map(
    map: Annotated[Path, typer.Argument(metavar="YAML", help="The map's YAML file.")],
    out: Out,
    agents: Agents = None,
    radius: Radius = None,
    unknown_is_free: Annotated[
        bool, typer.Option("--unknown-is-free", help="Agents may enter unknown cells of the map.")
    ] = False,
    name: Name = None,
    force: Force = False,
) -> None:
    """Convert an occupancy map of the ROS map_server."""
    import_file("import_map", locals(), format="ros-map")
