"""What a trainer is: it turns a recipe into weights, driven by `benchnav train`.

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
    """How far a training is."""

    decisions: int
    total: int
    success: float | None = None  # on the validation split, at the last checkpoint


class Trainer(ABC, Generic[R]):
    """One kind of learner."""

    Recipe: ClassVar[type[BaseModel]]  # what its recipe files say
    recipes: ClassVar[Path]  # folder of the recipes that it ships, NAME.yaml

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
        """Train into the folder ``out``, which then holds weights, curve and checkpoint.

        Raises:
            UsageError: the folder holds something else, or nothing to resume.
            TrainingError: learning went wrong.
        """


def trainer_rule(name: str, plugin: Any) -> str:
    """Return what the trainer ``name`` must be and is not; "" if there is nothing."""
    if not (isinstance(plugin, type) and issubclass(plugin, Trainer)):
        return f"be a class derived from {Trainer.__module__}.{Trainer.__qualname__}"
    missing = [part for part in ("Recipe", "recipes") if not hasattr(plugin, part)]
    return f"be a class that declares {' and '.join(missing)}" if missing else ""
