"""Training from a recipe, in segments that each start from a checkpoint and a seed.

A segment resets worlds, memories and every random stream, so a training that was
killed and resumed ends with the same bits as an uninterrupted one.
"""

import json
import platform
import sys
from collections.abc import Callable
from dataclasses import asdict, replace
from importlib.metadata import version
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import torch
from stable_baselines3.common.callbacks import CallbackList

from benchnav.envs import AgentBatch, AgentVecEnv, TrainingReport
from benchnav.envs.episode_stats import Tally
from benchnav.errors import TrainingError, UsageError
from benchnav.store.runs.lock import locked
from benchnav.threads import core_count

from ..actor import Actor
from ..foresight import foresee
from ..weights import write_weights
from . import checkpoint
from .checkpoint import Progress
from .courses import make_env, training_pools, validation_batches
from .evaluate import evaluate
from .learner import (
    SequencePPO,
    actor_tensors,
    copy_state,
    enter,
    make_learner,
    native_precision,
    reseed,
    set_discount,
    set_precision,
)
from .learner_group import LearnerGroup, learner_group
from .log import Curve
from .recipe import Precision, Recipe, Stage

VALIDATION = "validation "  # and the scenario: a column of the curve
WEIGHTS = "weights.safetensors"
Report = Callable[[TrainingReport], None]


class Training:
    """One run of one recipe with one seed in one folder."""

    def __init__(self, recipe: Recipe, seed: int, folder: Path, device: str = "cpu") -> None:
        self.recipe, self.seed, self.folder = recipe, seed, folder
        self._device = device
        self._group = LearnerGroup()

    def run(self, resume: bool, report: Report) -> dict[str, float]:
        """Train to the end; return the last row of the curve.

        Raises:
            UsageError: the folder has other content, or there is nothing to resume.
            TrainingError: a number is not finite; the last checkpoint is kept.
            RunConflictError: another process trains into the folder.
        """
        self._claim(resume)
        self.folder.mkdir(parents=True, exist_ok=True)
        with locked(self.folder):
            self._claim(resume)  # another process began at the same time
            arguments = (self.recipe, self.seed, self.folder, self._device, resume)
            with learner_group(self.recipe.processes, _learn_along, *arguments) as self._group:
                return self._run(resume, report)

    def _run(self, resume: bool, report: Report) -> dict[str, float]:
        progress = self._begin(resume)
        curve = Curve(self.folder, progress.decisions)
        try:
            while progress.stage < len(self.recipe.stages):
                row, progress = self._segment(progress, report)
                self._keep(row, progress, curve)
                report(TrainingReport(progress.decisions, self.recipe.decisions, _mean(row)))
        finally:
            curve.close()
        return curve.rows[-1] if curve.rows else {}

    def _learn_along(self, resume: bool) -> None:
        """Do what the process of rank 0 does, but write nothing."""
        progress = self._begin(resume)
        while progress.stage < len(self.recipe.stages):
            _, progress = self._segment(progress, lambda _: None)

    def _begin(self, resume: bool) -> Progress:
        """Prepare worlds and learner; return the progress so far."""
        torch.set_num_threads(1)
        self._lay_out(self.recipe.stages[0])
        self._validation = validation_batches(self.recipe)
        self._new_learner()
        progress = Progress(self.recipe.hash, self.seed)
        if resume:
            progress = checkpoint.load(self.folder, self.learner, self.recipe.hash, self.seed)
        progress = replace(progress, precision=progress.precision or self._precision())
        set_precision(self.learner, progress.precision or "float32")
        if self._group.rank == 0:
            if not resume:
                checkpoint.save(self.folder, self.learner, progress)
            self._report()
        return progress

    def _new_learner(self) -> None:
        self.learner = make_learner(self.recipe, self._env, self.seed, self._device)
        if isinstance(self.learner, SequencePPO):
            self.learner.join(self._group)

    def _precision(self) -> Precision:
        wanted = self.recipe.precision
        return native_precision(self.learner.device) if wanted == "auto" else wanted

    def _claim(self, resume: bool) -> None:
        there = (self.folder / checkpoint.FILE).exists()
        if there and not resume:
            raise UsageError(
                f"{self.folder} must be new or empty; it holds a training."
                " Continue it (option 'resume'), or choose another folder."
            )
        if resume and not there:
            raise UsageError(f"{self.folder} must hold a checkpoint to resume from. It does not.")

    def _report(self) -> None:
        """Write everything that is needed to repeat the training."""
        fields = {
            "recipe": self.recipe.model_dump(mode="json"), "hash": self.recipe.hash,
            "seed": self.seed, "machine": _machine(), "versions": _versions(),
        }  # fmt: skip
        (self.folder / "training.json").write_text(json.dumps(fields, indent=1) + "\n")

    def _lay_out(self, stage: Stage) -> None:
        """Draw the worlds of a stage."""
        self._courses = self.recipe.courses_of(stage)
        rows = self._group.share(self.recipe.rows)
        self._env = make_env(self.recipe, training_pools(self.recipe, stage), rows)

    def _enter(self, stage: Stage, seed: int) -> AgentVecEnv:
        """Return the restarted worlds of a stage."""
        if self.recipe.courses_of(stage) != self._courses:
            self._lay_out(stage)
            before = self.learner
            self._new_learner()
            copy_state(before, self.learner)
        correct = foresee if stage.foresight else None
        self._env.enter(stage.reward, seed, correct)
        for batch in self._validation.values():
            batch.correct = correct
        return self._env

    def _segment(self, progress: Progress, report: Report) -> tuple[dict[str, float], Progress]:
        """Train until the next checkpoint; return its row of the curve, and its progress."""
        began, stage = perf_counter(), self.recipe.stages[progress.stage]
        key = [self.seed, progress.segment, self._group.rank]
        rng = np.random.default_rng(key[: 3 if self._group.rank else 2])
        env = self._enter(stage, int(rng.integers(2**31)))
        learner = self.learner
        reseed(learner, rng)
        set_discount(learner, self.recipe.gamma_of(stage))
        learner._last_obs = None  # so that the worlds restart
        _, callback = learner._setup_learn(sys.maxsize, CallbackList([]))
        if isinstance(learner, SequencePPO):
            learner.forget()
        here = 0
        goal = min(self.recipe.checkpoint, stage.decisions - progress.in_stage)
        while here < goal:
            enter(learner, stage, (progress.in_stage + here) / stage.decisions)
            self._update(callback, progress.decisions + here)
            here = sum(self._group.gather(int(env.tally.counts["decisions"])))
            report(TrainingReport(progress.decisions + here, self.recipe.decisions))
        tally = Tally()
        for part in self._group.gather(env.tally):
            tally.merge(part)
        success = self._validate()
        progress = self._after(progress, here, float(np.mean(list(success.values()))))
        progress = replace(progress, seconds=progress.seconds + perf_counter() - began)
        row = tally.take() | {"decisions": progress.decisions}
        return row | {"stage": progress.stage, "seconds": progress.seconds, **success}, progress

    def _keep(self, row: dict[str, float], progress: Progress, curve: Curve) -> None:
        """Write a checkpoint, last of all, so that what belongs to it is on disk before."""
        curve.add(row)
        self._write_weights(progress, _success(row))
        checkpoint.save(self.folder, self.learner, progress)

    def _update(self, callback: Any, decisions: int) -> None:
        """Make one rollout, and learn from it."""
        learner = self.learner
        try:
            learner.collect_rollouts(
                self._env, callback, learner.rollout_buffer, self.recipe.rollout
            )
            learner.train()
        except (ValueError, RuntimeError):  # torch refuses a Gaussian that is not finite
            self._check_finite(decisions)
            raise
        self._check_finite(decisions)

    def _write_weights(self, progress: Progress, success: dict[str, float]) -> None:
        """Write the newest weights, and those of every checkpoint by its decisions."""
        history = self.folder / "checkpoints"
        history.mkdir(exist_ok=True)
        tensors, about = actor_tensors(self.learner), self._about(progress, success)
        for path in (self.folder / WEIGHTS, history / f"{progress.decisions:09d}.safetensors"):
            write_weights(path, tensors, about)

    def _after(self, progress: Progress, here: int, reached: float) -> Progress:
        recipe = self.recipe
        better = reached > progress.best
        waited = 0 if better else progress.waited + 1
        then = replace(
            progress, segment=progress.segment + 1, decisions=progress.decisions + here,
            in_stage=progress.in_stage + here, best=max(reached, progress.best), waited=waited,
        )  # fmt: skip
        ended = then.in_stage >= recipe.stages[then.stage].decisions
        if ended or (recipe.patience and waited >= recipe.patience):
            return replace(then, stage=then.stage + 1, in_stage=0, best=-1.0, waited=0)
        return then

    def _validate(self) -> dict[str, float]:
        """Return the success in each scenario; the processes share the scenarios."""
        actor, group = Actor(actor_tensors(self.learner)), self._group
        mine = list(self._validation.items())[group.rank :: group.size]
        parts = group.gather({name: _share(actor, batch) for name, batch in mine})
        success = {name: value for part in parts for name, value in part.items()}
        return {f"{VALIDATION}{name}": success[name] for name in self._validation}

    def _check_finite(self, decisions: int) -> None:
        for name, parameter in self.learner.policy.named_parameters():
            if not bool(torch.isfinite(parameter).all()):
                raise TrainingError(
                    f"{self.folder}: {name} must stay finite; it did not after {decisions}"
                    f" decisions. The last checkpoint and {WEIGHTS} are from before."
                )

    def _about(self, progress: Progress, success: dict[str, float]) -> dict[str, Any]:
        return {
            "encoder": self.recipe.encoder, "hidden_movers": self.recipe.hidden_movers,
            "network": self.recipe.network.model_dump(mode="json"),
            "recipe": self.recipe.name, "recipe_hash": self.recipe.hash,
            "courses": [course.model_dump() for course in self.recipe.courses],
            "progress": asdict(progress), "success": success,
            "machine": _machine(), "versions": _versions(),
        }  # fmt: skip


def _learn_along(
    group: LearnerGroup, recipe: Recipe, seed: int, folder: Path, device: str, resume: bool
) -> None:
    training = Training(recipe, seed, folder, device)
    training._group = group
    training._learn_along(resume)


def _success(row: dict[str, float]) -> dict[str, float]:
    return {name: value for name, value in row.items() if name.startswith(VALIDATION)}


def _mean(row: dict[str, float]) -> float:
    return float(np.mean(list(_success(row).values())))


def _share(actor: Actor, batch: AgentBatch) -> float:
    agents = sum(int(world.agents.evaluated.sum()) for world in batch.simulation.pool)
    return float(evaluate(actor, batch).sum() / agents)


def _machine() -> str:
    return f"{platform.machine()}, {core_count()} cores, {platform.system()}"


def _versions() -> dict[str, str]:
    names = ("benchnav", "numpy", "numba", "torch", "stable_baselines3", "sb3_contrib")
    return {"python": platform.python_version(), **{name: version(name) for name in names}}
