"""The complete state of a training, as one safetensors file written atomically."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import torch
from safetensors import safe_open
from safetensors.torch import save_file

from benchnav.errors import StoreError, UsageError

from .learner import Learner
from .recipe import Precision

FILE = "checkpoint.safetensors"


@dataclass(frozen=True)
class Progress:
    """The progress of a training."""

    recipe: str  # hash
    seed: int
    segment: int = 0  # checkpoints so far
    stage: int = 0
    decisions: int = 0  # of all stages
    in_stage: int = 0  # of this stage
    best: float = -1.0  # validation success in this stage
    waited: int = 0  # checkpoints since the best
    seconds: float = 0.0  # of training
    precision: Precision | None = None  # with which it began; None: of an older version


def save(folder: Path, learner: Learner, progress: Progress) -> None:
    """Replace the checkpoint of ``folder``."""
    tensors = {f"policy.{k}": v.contiguous() for k, v in learner.policy.state_dict().items()}
    for index, state in learner.policy.optimizer.state_dict()["state"].items():
        tensors |= {f"optimizer.{index}.{k}": v.contiguous() for k, v in state.items()}
    part = folder / (FILE + ".part")
    save_file(tensors, part, {"progress": json.dumps(asdict(progress))})
    part.replace(folder / FILE)


def load(folder: Path, learner: Learner, recipe: str, seed: int) -> Progress:
    """Load the checkpoint of ``folder`` into ``learner``.

    Raises:
        UsageError: it was made with another recipe or seed.
        StoreError: the file is incomplete.
    """
    path = folder / FILE
    try:
        with safe_open(path, framework="pt") as file:
            progress = Progress(**json.loads(file.metadata()["progress"]))
            tensors: dict[str, torch.Tensor] = {k: file.get_tensor(k) for k in file.keys()}  # noqa: SIM118
    except Exception as error:
        raise StoreError(f"{path}: must be a complete checkpoint: {str(error)[:200]}.") from None
    if (progress.recipe, progress.seed) != (recipe, seed):
        raise UsageError(
            f"{folder} holds the training of recipe {progress.recipe} with seed {progress.seed}."
            f" Resuming needs the same; got recipe {recipe} with seed {seed}."
            " Choose another folder, or use its recipe and seed."
        )
    policy = {k[7:]: v for k, v in tensors.items() if k.startswith("policy.")}
    learner.policy.load_state_dict(policy)
    optimizer = learner.policy.optimizer.state_dict()
    state: dict[int, dict[str, Any]] = {}
    for key, value in tensors.items():
        if key.startswith("optimizer."):
            _, index, name = key.split(".")
            state.setdefault(int(index), {})[name] = value
    learner.policy.optimizer.load_state_dict({**optimizer, "state": state})
    return progress
