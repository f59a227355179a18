"""The trainer behind `benchnav train` for recipes of the table."""

from collections.abc import Callable
from pathlib import Path
from time import process_time
from typing import ClassVar

from pydantic import BaseModel

from benchnav.envs.trainer import Trainer, TrainingReport
from benchnav.errors import UsageError

from . import recipe
from .table import Table, save
from .train import train

WEIGHTS = "weights.safetensors"


class QLearningTrainer(Trainer[recipe.Recipe]):
    """Tabular Q-learning on one core, in about a minute."""

    Recipe: ClassVar[type[BaseModel]] = recipe.Recipe
    recipes: ClassVar[Path] = Path(__file__).parent / "recipes"

    def train(
        self,
        recipe: recipe.Recipe,
        seed: int,
        out: Path,
        *,
        resume: bool,
        device: str,
        report: Callable[[TrainingReport], None],
    ) -> None:
        if resume:
            raise UsageError(
                "q-learning keeps no checkpoints, so it cannot resume. Leave the option out:"
                " a whole training takes about a minute."
            )
        if device not in ("cpu", "auto"):
            raise UsageError(f"The device must be cpu or auto for q-learning. Got {device!r}.")
        if (out / WEIGHTS).exists():
            raise UsageError(f"{out} must be a new folder. It holds {WEIGHTS}.")
        out.mkdir(parents=True, exist_ok=True)
        began = process_time()
        learner, steps = train(recipe, seed, report)
        seconds = round(process_time() - began, 1)
        save(out / WEIGHTS, Table.of(learner, seed=seed, steps=steps, seconds=seconds))
