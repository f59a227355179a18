"""The worlds in which a recipe trains and validates."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchnav.arena import World
from benchnav.envs import AgentBatch, AgentVecEnv, RewardWeights, encoder
from benchnav.generation.build import build
from benchnav.navigation import Spec
from benchnav.scenario.catalogue import find

from .recipe import Recipe, Stage


@dataclass(frozen=True, eq=False)
class Pool:
    """Worlds that share clock, sensing, goal tolerance and drivers."""

    worlds: Sequence[World]
    drivers: tuple[Spec, ...]


class CourseEnv(AgentVecEnv):
    """An environment whose idle steps count as done: the memory is empty at the next attempt."""

    def step_wait(self) -> Any:
        observation, reward, done, infos = super().step_wait()
        return observation, reward, done | self.woke, infos


def training_pools(recipe: Recipe, stage: Stage) -> list[Pool]:
    """Return the worlds of a stage."""
    pools: dict[str, Pool] = {}
    for course in recipe.courses_of(stage):
        new = _pool(course.scenario, "train", course.worlds)
        first = new.worlds[0]
        key = repr((first.clock, first.sensing, first.rules.goal_tolerance, new.drivers))
        held = pools.get(key, Pool((), new.drivers))
        pools[key] = Pool((*held.worlds, *new.worlds), new.drivers)
    return list(pools.values())


def make_env(recipe: Recipe, pools: Sequence[Pool]) -> AgentVecEnv:
    """Return an environment; pools share rows by their numbers of worlds, at least one each."""
    total = sum(len(pool.worlds) for pool in pools)
    return CourseEnv(
        [
            _batch(recipe, pool, max(1, round(recipe.rows * len(pool.worlds) / total)))
            for pool in pools
        ]
    )


def validation_batches(recipe: Recipe) -> dict[str, AgentBatch]:
    """Return worlds of the split `validation`, by scenario; every world has its own row."""
    validation = recipe.validation
    names = validation.scenarios or tuple(course.scenario for course in recipe.courses)
    pools = {name: _pool(name, "validation", validation.worlds) for name in names}
    return {name: _batch(recipe, pool, len(pool.worlds)) for name, pool in pools.items()}


def _pool(name: str, split: str, count: int) -> Pool:
    scenario = find(name)
    return Pool([build(scenario, split, seed) for seed in range(count)], scenario.driver_specs)


def _batch(recipe: Recipe, pool: Pool, rows: int) -> AgentBatch:
    return AgentBatch(
        pool.worlds, rows, encoder(recipe.encoder), RewardWeights(), np.random.default_rng(0),
        drivers=pool.drivers,
    )  # fmt: skip
