"""The plugin of `benchnav train`: its recipes, and the call of the training.

Heavy modules are imported only for a training.
"""

from collections.abc import Callable
from pathlib import Path
from typing import ClassVar

from pydantic import BaseModel

from benchnav.envs import Trainer, TrainingReport
from benchnav.errors import MissingExtraError, UsageError

from . import recipe

DEVICES = ("cpu", "cuda", "auto")


class RecurrentPPOTrainer(Trainer[recipe.Recipe]):
    """Proximal policy optimisation with an LSTM (sb3-contrib), or without one."""

    Recipe: ClassVar[type[BaseModel]] = recipe.Recipe
    recipes: ClassVar[Path] = Path(__file__).parents[1] / "recipes"

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
        if device.partition(":")[0] not in DEVICES:
            raise UsageError(
                f"The device must be one of {', '.join(DEVICES)}. Got {device!r} instead."
            )
        try:
            from .segments import Training
        except ImportError as error:
            raise MissingExtraError(f"Training (it lacks {error.name})", "learn") from None
        Training(recipe, seed, out, device).run(resume, report)
