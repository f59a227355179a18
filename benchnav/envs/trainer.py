"""The contract of a trainer: it turns a recipe into weights, for `benchnav train`.

A trainer is registered in the entry-point group `benchnav.trainers` under the name that
its recipes give as `trainer`.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Generic, TypeVar

from pydantic import BaseModel

R = TypeVar("R", bound=BaseModel)


@dataclass(frozen=True)
class TrainingReport:
    """The progress of a training."""

    decisions: int
    total: int
    success: float | None = None  # on the validation split, at the last checkpoint


class Trainer(ABC, Generic[R]):
    """One kind of learner."""

    Recipe: ClassVar[type[BaseModel]]  # the model of its recipe files
    recipes: ClassVar[Path]  # folder of its recipes, NAME.yaml
    weights: ClassVar[str] = "weights.safetensors"  # name of the file that a navigator reads

    @abstractmethod
    def train(
        self,
        recipe: R,
        seed: int,
        out: Path,
        *,
        resume: bool,
        device: str,
        report: Callable[[TrainingReport], None],
    ) -> None:
        """Train, and write `weights`, curve and checkpoints to the folder ``out``.

        Raises:
            UsageError: the folder has other content, or nothing to resume.
            TrainingError: the training failed.
        """


def trainer_rule(name: str, plugin: Any) -> str:
    """Return the requirement that the trainer ``name`` violates, as a verb phrase; "" if none."""
    if not (isinstance(plugin, type) and issubclass(plugin, Trainer)):
        return f"be a class derived from {Trainer.__module__}.{Trainer.__qualname__}"
    missing = [part for part in ("Recipe", "recipes") if not hasattr(plugin, part)]
    return f"be a class that declares {' and '.join(missing)}" if missing else ""
