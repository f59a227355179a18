"""One training: learn, and at every checkpoint measure success and write the policy."""

import json
import platform
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import torch
import yaml
from stable_baselines3.common.callbacks import BaseCallback

from benchnav import make_env
from benchnav.envs import AgentBatch, AgentVecEnv, AttemptMonitor, TrainingReport
from benchnav.errors import TrainingError, UsageError
from benchnav.store.runs.lock import locked

from ..policy.loading import Policy, PolicyConfig, load_policy
from ..recurrent_ppo.learning.evaluate import evaluate
from ..recurrent_ppo.learning.log import Curve
from .algorithms import LinearRate, make_learner
from .recipe import Recipe
from .trainer import POLICY

Report = Callable[[TrainingReport], None]


class Training:
    """One run of one recipe with one seed in one folder."""

    def __init__(
        self, recipe: Recipe, seed: int, folder: Path, device: str, report: Report
    ) -> None:
        self.recipe, self.seed, self.folder, self.report = recipe, seed, folder, report
        self.decisions = 0
        self._checked = 0  # decisions at the last checkpoint
        torch.set_num_threads(1)
        self.env = _environment(recipe)
        self._validation = _validation(recipe)
        monitor = AttemptMonitor(self.env)
        try:
            self.learner = make_learner(recipe, monitor, seed, device)
        except RuntimeError as error:  # of torch
            raise UsageError(f"The device {device!r} cannot be used: {error}") from None

    def run(self) -> None:
        """Train to the end. Raises TrainingError if a number is not finite."""
        self.folder.mkdir(parents=True, exist_ok=True)
        with locked(self.folder):
            self._began = perf_counter()
            self._curve = Curve(self.folder, 0)
            self._write_recipe()
            try:
                self.learner.learn(10**12, callback=_Checkpoints(self))
            except ValueError as error:  # torch refuses a Gaussian that is not finite
                self._check_finite()
                raise TrainingError(f"{self.folder}: the training failed: {error}") from error
            finally:
                self._curve.close()

    def step(self) -> bool:
        """Count the decisions of a step; return whether the training goes on."""
        self.decisions += int(self.env.acted.sum())
        rate = self.learner.learning_rate
        if isinstance(rate, LinearRate):
            rate.done = self.decisions / self.recipe.decisions
        done = self.decisions >= self.recipe.decisions
        if done or self.decisions - self._checked >= self.recipe.checkpoint:
            self._checked = self.decisions
            self._checkpoint()
        return not done

    def report_progress(self, success: float | None = None) -> None:
        """Report the decisions so far."""
        now = min(self.decisions, self.recipe.decisions)
        self.report(TrainingReport(now, self.recipe.decisions, success))

    def _checkpoint(self) -> None:
        self._check_finite()
        seconds = perf_counter() - self._began
        history = self.folder / "checkpoints"
        history.mkdir(exist_ok=True)
        for path in (history / f"{self.decisions:09d}.zip", self.folder / POLICY):
            self._write_policy(path, seconds)
        policy = load_policy(PolicyConfig(file=str(self.folder / POLICY)))
        success = {
            f"validation {name}": _share(policy, batch) for name, batch in self._validation.items()
        }
        row = self.env.tally.take()
        row |= {"decisions": self.decisions, "stage": 0, "seconds": seconds, **success}
        self._curve.add(row)
        self.report_progress(float(np.mean(list(success.values()))))

    def _write_policy(self, path: Path, seconds: float) -> None:
        """Write the policy, and beside it the facts that its file does not hold."""
        facts = {
            "encoder": self.recipe.encoder, "decisions": self.decisions,
            "seconds": round(seconds, 1),
            "training": {"recipe": self.recipe.name, "algorithm": self.recipe.algorithm,
                         "seed": self.seed},
        }  # fmt: skip
        path.with_suffix(".yaml").write_text(yaml.safe_dump(facts, sort_keys=False))
        part = path.with_name("part.zip")
        self.learner.save(part)
        part.replace(path)

    def _write_recipe(self) -> None:
        fields = {
            "recipe": self.recipe.model_dump(mode="json"), "seed": self.seed,
            "versions": {"python": platform.python_version(), **{
                name: version(name)
                for name in ("benchnav", "numpy", "torch", "stable_baselines3", "sb3_contrib")
            }},
        }  # fmt: skip
        (self.folder / "training.json").write_text(json.dumps(fields, indent=1) + "\n")

    def _check_finite(self) -> None:
        for name, parameter in self.learner.policy.named_parameters():
            if not bool(torch.isfinite(parameter).all()):
                raise TrainingError(
                    f"{self.folder}: {name} must stay finite; it did not after {self.decisions}"
                    " decisions. The policies of earlier checkpoints are kept."
                )


class _Checkpoints(BaseCallback):
    """Calls a training after each step of the environment."""

    def __init__(self, training: Training) -> None:
        super().__init__()
        self._training = training

    def _on_step(self) -> bool:
        return self._training.step()

    def _on_rollout_end(self) -> None:
        self._training.report_progress()


class _Decider:
    """A policy as `evaluate` calls it."""

    def __init__(self, policy: Policy) -> None:
        self._policy = policy
        self.state_size = policy.network.state_size

    def decide(self, x: Any, state: Any) -> Any:
        return self._policy.actions(x, state).astype(np.float32)


def _share(policy: Policy, batch: AgentBatch) -> float:
    agents = sum(int(world.agents.evaluated.sum()) for world in batch.simulation.pool)
    return float(evaluate(_Decider(policy), batch).sum() / agents)


def _batch(recipe: Recipe, scenario: str, split: str, worlds: int, rows: int) -> AgentBatch:
    env: Any = make_env(
        scenario, kind="sb3", num_worlds=rows, encoder=recipe.encoder, split=split, worlds=worlds,
        reward=recipe.reward, perception=recipe.perception,
    )  # fmt: skip
    batch: AgentBatch = env.unwrapped.batches[0]
    return batch


def _environment(recipe: Recipe) -> AgentVecEnv:
    return AgentVecEnv(
        [_batch(recipe, c.scenario, "train", c.worlds, c.rows) for c in recipe.courses]
    )


def _validation(recipe: Recipe) -> dict[str, AgentBatch]:
    names = recipe.validation.scenarios or tuple(course.scenario for course in recipe.courses)
    worlds = recipe.validation.worlds
    return {name: _batch(recipe, name, "validation", worlds, worlds) for name in names}
