"""The worlds that a recipe learns and validates in."""

from collections.abc import Sequence

import numpy as np

from benchnav.arena.world import World
from benchnav.envs.agent_batch import AgentBatch
from benchnav.envs.agent_vec_env import AgentVecEnv
from benchnav.envs.encoders.catalogue import encoder
from benchnav.envs.reward import RewardWeights
from benchnav.errors import UsageError
from benchnav.scenario.catalogue import find
from benchnav.world.build import build

from .recipe import Recipe, Stage


def training_worlds(recipe: Recipe, stage: Stage) -> list[list[World]]:
    """Pools of a stage, one for each set of terms (clock, sensing, goal tolerance) that occurs."""
    pools: dict[str, list[World]] = {}
    for course in recipe.courses_of(stage):
        scenario = find(course.scenario)
        if scenario.drivers:
            raise UsageError(
                f"The recipe {recipe.name!r} must name scenarios whose agents are all evaluated."
                f" {scenario.identity} has a team with a driver."
            )
        worlds = [build(scenario, "train", seed) for seed in range(course.worlds)]
        first = worlds[0]
        key = repr((first.clock, first.sensing, first.rules.goal_tolerance))
        pools.setdefault(key, []).extend(worlds)
    return list(pools.values())


def make_env(recipe: Recipe, pools: Sequence[Sequence[World]]) -> AgentVecEnv:
    """Rows are shared between the pools by their numbers of worlds, at least one each."""
    total = sum(len(pool) for pool in pools)
    batches = [
        AgentBatch(
            pool, max(1, round(recipe.rows * len(pool) / total)), encoder(recipe.encoder),
            RewardWeights(), np.random.default_rng(0),
        )
        for pool in pools
    ]  # fmt: skip
    return AgentVecEnv(batches)


def validation_worlds(recipe: Recipe) -> dict[str, list[World]]:
    """Worlds of the split `validation`, by scenario."""
    wanted = recipe.validation
    names = wanted.scenarios or tuple(course.scenario for course in recipe.courses)
    return {
        name: [build(find(name), "validation", seed) for seed in range(wanted.worlds)]
        for name in names
    }
