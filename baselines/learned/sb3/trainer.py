"""The trainer behind `benchnav train` for recipes that name an algorithm of a library."""

from collections.abc import Callable
from pathlib import Path
from typing import ClassVar

from pydantic import BaseModel

from benchnav.envs import Trainer, TrainingReport
from benchnav.errors import MissingExtraError, UsageError

from . import recipe

POLICY = "policy.zip"


class Sb3Trainer(Trainer[recipe.Recipe]):
    """An algorithm of Stable-Baselines3 or sb3-contrib; `policy` drives with the result."""

    Recipe: ClassVar[type[BaseModel]] = recipe.Recipe
    recipes: ClassVar[Path] = Path(__file__).parent / "recipes"
    weights: ClassVar[str] = POLICY

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
                "This trainer cannot resume: these algorithms do not save all of their state."
                " Train in a new folder; the policies of the checkpoints are kept."
            )
        if (out / POLICY).exists():
            raise UsageError(f"{out} must be a new folder. It holds {POLICY}.")
        try:
            from .training import Training
        except ImportError as error:
            raise MissingExtraError(f"Training (it lacks {error.name})", "learn") from None
        Training(recipe, seed, out, device, report).run()
