"""`benchnav train`: weights from a recipe."""

from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from benchnav.cli.console import put, say
from benchnav.errors import UsageError, did_you_mean

if TYPE_CHECKING:
    from benchnav.envs.trainer import Trainer


def train(
    recipe: Annotated[
        str, typer.Argument(metavar="RECIPE", help="Name of a recipe that ships, or a file.")
    ],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder of the training. [default: new]")
    ] = None,
    seed: Annotated[int, typer.Option(metavar="N", min=0, help="Of everything random.")] = 0,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on from the folder's last checkpoint.")
    ] = False,
    device: Annotated[
        str, typer.Option(metavar="NAME", help="cpu, cuda, or auto; same weights on cpu only.")
    ] = "cpu",
    quiet: Annotated[bool, typer.Option("--quiet", help="Print errors only.")] = False,
) -> None:
    """Train a navigator from a recipe.

    Prints the file of the weights on stdout. A training that was interrupted or killed
    goes on with --resume, and ends in the same weights.
    """
    from benchnav.cli.running.training_progress import training_progress

    trainer, content = _load(recipe)
    name = getattr(content, "name", Path(recipe).stem)
    folder = out if out is not None else Path("runs") / f"{name}-{datetime.now():%Y%m%d-%H%M%S}"
    if not quiet:
        say(f"{name}, seed {seed}, into {folder}")
    with training_progress(quiet) as report:
        try:
            trainer.train(content, seed, folder, resume=resume, device=device, report=report)
        except KeyboardInterrupt as stopped:
            stopped.add_note(
                "the last checkpoint is kept."
                f" Go on with: benchnav train {recipe} --out {folder} --resume"
            )
            raise
    put(str(folder / "weights.safetensors"))


def _load(name: str) -> tuple["Trainer[Any]", Any]:
    """Return the trainer and the validated recipe of a name or file."""
    from benchnav.config.yaml_reader import read_yaml, validate
    from benchnav.errors import ScenarioError
    from benchnav.plugins import TRAINERS

    path = _path(name)
    document = read_yaml(path)
    kind = document.data.get("trainer") if isinstance(document.data, dict) else None
    if kind not in TRAINERS.names():
        got = "no such key" if kind is None else repr(kind)
        raise ScenarioError(
            f"{document.where(('trainer',))} must be one of {', '.join(TRAINERS.names())};"
            f" got {got}.{did_you_mean(str(kind), TRAINERS.names())}"
        )
    trainer: Trainer[Any] = TRAINERS.load(kind)()
    return trainer, validate(trainer.Recipe, document)


def _path(name: str) -> Path:
    if name.endswith((".yaml", ".yml")) or Path(name).is_file():
        return Path(name)
    from benchnav.envs.recipes import recipe_files

    found, broken = recipe_files()
    if name not in found:
        causes = "".join(f" {error}" for error in broken.values())
        raise UsageError(
            f"There is no recipe {name!r}.{did_you_mean(name, found)}"
            f" 'benchnav list recipes' shows all; a file's name ends in .yaml.{causes}"
        )
    return found[name].path
