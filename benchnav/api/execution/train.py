"""Train a navigator from a recipe: what `benchnav.train` and the command do."""

from collections.abc import Mapping
from dataclasses import replace
from datetime import datetime
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchnav.api.output.messages import message, silent
from benchnav.api.output.training_progress import training_progress
from benchnav.api.records.training import Training
from benchnav.config.yaml_reader import document_of, read_yaml, validate
from benchnav.errors import ScenarioError, UsageError, did_you_mean
from benchnav.plugins import TRAINERS
from benchnav.processes.main_module import stop_import_of_main

if TYPE_CHECKING:
    from benchnav.config.document import Document
    from benchnav.envs.trainer import Trainer

RecipeLike = str | PathLike[str] | Mapping[str, Any]
"""Name or file of a recipe, or the content of a recipe file."""


def train(
    recipe: RecipeLike,
    *,
    seed: int = 0,
    out: str | PathLike[str] | None = None,
    resume: bool = False,
    device: str = "cpu",
    processes: int | None = None,
    quiet: bool = False,
) -> Training:
    """Train a navigator from a recipe, and return the folder with the weights.

    A training that was interrupted continues with the same call and ``resume=True``, and ends
    in the same weights.

    Args:
        recipe: a name that ``benchnav.available("recipes")`` has, a YAML file, or its content
            as a dict.
        seed: of everything random.
        out: the folder; None: a new one in ``runs``.
        resume: continue from the last checkpoint in ``out``.
        device: "cpu", "cuda" or "auto". Only on "cpu" are the weights the same each time.
        processes: overrides the key of the recipe; one for each core trains fastest. Another
            number of processes gives other weights.
        quiet: print no progress.

    Raises UsageError or ScenarioError for a mistake in the call or in the recipe,
    MissingExtraError where the trainer needs an extra, and TrainingError where it fails.
    """
    stop_import_of_main()
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise UsageError(f"The seed must be a whole number from 0. Got {seed!r} instead.")
    document = _document(recipe)
    kind, trainer = _trainer(document)
    if processes is not None:
        document = replace(document, data={**document.data, "processes": processes})
    content = validate(trainer.Recipe, document)
    name = str(getattr(content, "name", Path(document.name).stem))
    folder = Path(out) if out is not None else _new_folder(name)
    (silent if quiet else message)(f"{name}, seed {seed}, into {folder}")
    with training_progress(quiet) as report:
        try:
            trainer.train(content, seed, folder, resume=resume, device=device, report=report)
        except KeyboardInterrupt as stopped:
            stopped.add_note(
                "the last checkpoint is kept. To continue, train the same recipe with the folder"
                f" {folder} as out and with resume."
            )
            raise
    return Training(name, kind, seed, folder)


def _new_folder(name: str) -> Path:
    return Path("runs") / f"{name}-{datetime.now():%Y%m%d-%H%M%S}"


def _document(recipe: RecipeLike) -> "Document":
    if isinstance(recipe, Mapping):
        return document_of(recipe, "recipe")
    return read_yaml(_path(str(recipe)))


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


def _trainer(document: "Document") -> "tuple[str, Trainer[Any]]":
    """Return the name and the trainer that a recipe names.

    Raises ScenarioError where the recipe names none, or one that is not installed.
    """
    names = TRAINERS.names()
    known = ", ".join(names) or "none, because no trainer is installed"
    if not isinstance(document.data, dict):
        raise ScenarioError(f"{document.where()} a recipe must be a mapping of keys to values.")
    if "trainer" not in document.data:
        near = did_you_mean("trainer", document.data).replace("Did you mean", "Or rename the key")
        raise ScenarioError(
            f"{document.where()} the key 'trainer' is missing: a recipe names the method that"
            f" learns. Add the line 'trainer: NAME' with one of these names: {known}."
            f"{near.replace('?', '.')}"
        )
    name = document.data["trainer"]
    if name not in names:
        raise ScenarioError(
            f"{document.where(('trainer',))} must be one of {known}; got {name!r}."
            f"{did_you_mean(str(name), names)}"
        )
    return name, TRAINERS.load(name)()
