"""The worlds that a recipe learns and validates in."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchnav.arena.world import World
from benchnav.envs.agent_batch import AgentBatch
from benchnav.envs.encoders.catalogue import encoder
from benchnav.envs.reward import RewardWeights
from benchnav.envs.sb3.agent_vec_env import AgentVecEnv
from benchnav.generation.build import build
from benchnav.navigation.plugin.configure import Spec
from benchnav.scenario.catalogue import find

from .recipe import Recipe, Stage


@dataclass(frozen=True, eq=False)
class Pool:
    """Worlds that share clock, sensing, goal tolerance and drivers."""

    worlds: Sequence[World]
    drivers: tuple[Spec, ...]


class CourseEnv(AgentVecEnv):
    """Idle stretches are done, too: a memory is emptied before the next attempt begins."""

    def step_wait(self) -> Any:
        observation, reward, done, infos = super().step_wait()
        return observation, reward, done | self.woke, infos


def training_pools(recipe: Recipe, stage: Stage) -> list[Pool]:
    """The worlds of a stage."""
    pools: dict[str, Pool] = {}
    for course in recipe.courses_of(stage):
        new = _pool(course.scenario, "train", course.worlds)
        first = new.worlds[0]
        key = repr((first.clock, first.sensing, first.rules.goal_tolerance, new.drivers))
        held = pools.get(key, Pool((), new.drivers))
        pools[key] = Pool((*held.worlds, *new.worlds), new.drivers)
    return list(pools.values())


def make_env(recipe: Recipe, pools: Sequence[Pool]) -> AgentVecEnv:
    """Rows are shared between the pools by their numbers of worlds, at least one each."""
    total = sum(len(pool.worlds) for pool in pools)
    return CourseEnv(
        [
            _batch(recipe, pool, max(1, round(recipe.rows * len(pool.worlds) / total)))
            for pool in pools
        ]
    )


def validation_batches(recipe: Recipe) -> dict[str, AgentBatch]:
    """Worlds of the split `validation`, by scenario; every world has a row of its own."""
    wanted = recipe.validation
    names = wanted.scenarios or tuple(course.scenario for course in recipe.courses)
    pools = {name: _pool(name, "validation", wanted.worlds) for name in names}
    return {name: _batch(recipe, pool, len(pool.worlds)) for name, pool in pools.items()}


def _pool(name: str, split: str, count: int) -> Pool:
    scenario = find(name)
    return Pool([build(scenario, split, seed) for seed in range(count)], scenario.driver_specs)


def _batch(recipe: Recipe, pool: Pool, rows: int) -> AgentBatch:
    return AgentBatch(
        pool.worlds, rows, encoder(recipe.encoder), RewardWeights(), np.random.default_rng(0),
        drivers=pool.drivers,
    )  # fmt: skip
