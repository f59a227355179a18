"""`benchnav import`: convert maps of other projects into scenario files."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import put
from benchnav.cli.stopping import stoppable

import_app = typer.Typer(
    help="Convert a map, a world or a recording of people into a scenario.", no_args_is_help=True
)

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


@import_app.command("movingai")
@stoppable
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
    from benchnav.api.authoring.import_map import import_map

    files = import_map(
        map, out, format="movingai", scen=scen, agents=agents, bucket=bucket, cell=cell,
        radius=radius, name=name, force=force,
    )  # fmt: skip
    put("\n".join(str(file) for file in files))


@import_app.command("ros-map")
@stoppable
def ros_map(
    map: Annotated[Path, typer.Argument(metavar="YAML", help="The map's YAML file.")],
    out: Out,
    agents: Agents = None,
    radius: Annotated[
        float | None,
        typer.Option(metavar="M", help="Agent radius [m]. [default: 0.2, or less on a small map]"),
    ] = None,
    unknown_is_free: Annotated[
        bool, typer.Option("--unknown-is-free", help="Agents may enter unknown cells of the map.")
    ] = False,
    name: Name = None,
    force: Force = False,
) -> None:
    """Convert an occupancy map of the ROS map_server."""
    from benchnav.api.authoring.import_map import import_map

    files = import_map(
        map, out, format="ros-map", agents=agents, radius=radius,
        unknown_is_free=unknown_is_free, name=name, force=force,
    )  # fmt: skip
    put("\n".join(str(file) for file in files))
