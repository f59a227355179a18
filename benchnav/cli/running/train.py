"""`benchnav train`: weights from a recipe."""

from pathlib import Path
from typing import Annotated

import typer

from benchnav.cli.console import put


def train(
    recipe: Annotated[
        str, typer.Argument(metavar="RECIPE", help="Name of a recipe that ships, or a file.")
    ],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder of the training. [default: new]")
    ] = None,
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Of everything random.")] = 0,
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue from the folder's last checkpoint.")
    ] = False,
    device: Annotated[
        str, typer.Option(metavar="NAME", help="cpu, cuda, or auto; same weights on cpu only.")
    ] = "cpu",
    processes: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, help="Learners, one a core. [default: the recipe's]"),
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print errors only.")] = False,
) -> None:
    """Train a navigator from a recipe.

    Prints the file of the weights on stdout. A training that was interrupted or killed
    continues with --resume, and ends in the same weights.
    """
    from benchnav.api.execution.train import train as execute

    done = execute(
        recipe, seed=seed, out=out, resume=resume, device=device, processes=processes, quiet=quiet
    )
    put(str(done.weights))
