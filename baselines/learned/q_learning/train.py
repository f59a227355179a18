"""Train the Q-table in worlds of the split `train`.

The same recipe and seed give the same table, bit for bit.
"""

from collections.abc import Callable

import numpy as np

from benchnav.arena import World
from benchnav.envs.trainer import TrainingReport
from benchnav.generation.build import build
from benchnav.scenario.catalogue import find

from .encoder import SITUATIONS
from .learner import Learner
from .moves import MOVES
from .practice import Practice
from .recipe import Recipe

EVERY = 50  # rounds between reports


def worlds_of(recipe: Recipe, seed: int) -> list[World]:
    """Return different worlds: seeds from ``seed`` times their number, the scenarios in turn."""
    scenarios = [find(name) for name in recipe.scenarios]
    first = seed * recipe.worlds
    return [
        build(scenarios[k % len(scenarios)], "train", first + k // len(scenarios))
        for k in range(recipe.worlds)
    ]


def train(
    recipe: Recipe, seed: int, report: Callable[[TrainingReport], None]
) -> tuple[Learner, int]:
    """Return the learned table, and how many decisions it took."""
    rng = np.random.default_rng(np.random.SeedSequence([seed]))
    practice = Practice(worlds_of(recipe, seed), recipe.reward)
    learner = Learner(np.zeros((SITUATIONS, len(MOVES))), recipe.discount)
    steps = 0
    for k in range(recipe.rounds):
        explore, rate = recipe.at(recipe.explore, k), recipe.at(recipe.rate, k)
        steps += practice.run(learner, recipe.decisions, explore, rate, rng)
        practice.restart(recipe.patience)
        if (k + 1) % EVERY == 0 or k + 1 == recipe.rounds:
            report(TrainingReport(steps, round(steps / (k + 1) * recipe.rounds)))
    return learner, steps
