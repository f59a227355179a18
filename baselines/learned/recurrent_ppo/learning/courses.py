"""The worlds in which a recipe trains and validates."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from benchnav.arena import Noise, World
from benchnav.envs import AgentBatch, AgentVecEnv, RewardWeights, encoder
from benchnav.generation.build import build, noise_of
from benchnav.navigation import Spec
from benchnav.scenario.catalogue import find

from ..sightings import memory_for
from .recipe import Recipe, Stage


@dataclass(frozen=True, eq=False)
class Pool:
    """Worlds that share clock, sensing, goal tolerance, drivers and noise."""

    worlds: Sequence[World]
    drivers: tuple[Spec, ...]
    noise: Noise | None  # of the senses; None: the perception track `exact`


class CourseEnv(AgentVecEnv):
    """An environment whose idle steps count as done: the memory is empty at the next attempt."""

    def step_wait(self) -> Any:
        observation, reward, done, infos = super().step_wait()
        return observation, reward, done | self.woke, infos


def training_pools(recipe: Recipe, stage: Stage) -> list[Pool]:
    """Return the worlds of a stage."""
    pools: dict[str, Pool] = {}
    for course in recipe.courses_of(stage):
        new = _pool(recipe, course.scenario, "train", course.worlds)
        first = new.worlds[0]
        key = repr((first.clock, first.sensing, first.rules.goal_tolerance, new.drivers, new.noise))
        held = pools[key].worlds if key in pools else ()
        pools[key] = replace(new, worlds=(*held, *new.worlds))
    return list(pools.values())


def make_env(recipe: Recipe, pools: Sequence[Pool], rows: int | None = None) -> AgentVecEnv:
    """Return an environment; pools share rows by their numbers of worlds, at least one each."""
    rows = recipe.rows if rows is None else rows
    total = sum(len(pool.worlds) for pool in pools)
    return CourseEnv(
        [_batch(recipe, pool, max(1, round(rows * len(pool.worlds) / total))) for pool in pools]
    )


def validation_batches(recipe: Recipe) -> dict[str, AgentBatch]:
    """Return worlds of the split `validation`, by scenario; every world has its own row."""
    validation = recipe.validation
    names = validation.scenarios or tuple(course.scenario for course in recipe.courses)
    pools = {name: _pool(recipe, name, "validation", validation.worlds) for name in names}
    return {name: _batch(recipe, pool, len(pool.worlds)) for name, pool in pools.items()}


def _pool(recipe: Recipe, name: str, split: str, count: int) -> Pool:
    scenario = find(name)
    worlds = [build(scenario, split, seed) for seed in range(count)]
    noise = noise_of(scenario) if recipe.perception == "noisy" else None
    return Pool(worlds, scenario.driver_specs, noise)


def _batch(recipe: Recipe, pool: Pool, rows: int) -> AgentBatch:
    return AgentBatch(
        pool.worlds, rows, encoder(recipe.encoder), RewardWeights(), np.random.default_rng(0),
        drivers=pool.drivers, noise=pool.noise, reverse=False,  # as `PolicyPilot` drives
        memory=memory_for(recipe.hidden_movers),
    )  # fmt: skip
