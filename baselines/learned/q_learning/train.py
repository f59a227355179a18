"""Trains the table: ``python -m benchnav_baselines.learned.q_learning.train --seed 0 --out FILE``.

Worlds are those of split train. The same seed and rounds give the same table, bit for bit;
besides it, the file says how long training took.
"""

import argparse
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from time import process_time

import numpy as np

from benchnav.arena.world import World
from benchnav.generation.build import build
from benchnav.scenario.catalogue import find

from .encoder import SITUATIONS
from .learner import Learner
from .moves import MOVES
from .practice import Practice, Reward
from .table import Table, save

SCENARIOS = ("leaders/static", "leaders/dynamic")
Say = Callable[[str], None]


@dataclass(frozen=True)
class Recipe:
    """How long and how boldly to learn."""

    rounds: int = 700
    decisions: int = 8  # of a round, in every world
    worlds: int = 1024  # the scenarios in turn
    patience: int = 100  # decisions after which a world starts over
    discount: float = 0.96  # γ per decision
    explore: tuple[float, float] = (0.3, 0.02)  # share of moves that are tried, at first and last
    rate: tuple[float, float] = (0.1, 0.003)  # step size, at first and last
    reward: Reward = field(default_factory=Reward)

    def at(self, ends: tuple[float, float], k: int) -> float:
        """Between the two values, geometrically, in round k."""
        share = min(1.0, k / max(0.85 * self.rounds, 1.0))
        return float(ends[0] * (ends[1] / ends[0]) ** share)


def worlds_of(recipe: Recipe, seed: int) -> list[World]:
    """Different ones: seeds from ``seed`` times its size upwards, the scenarios in turn."""
    scenarios = [find(name) for name in SCENARIOS]
    first = seed * recipe.worlds
    return [
        build(scenarios[k % len(scenarios)], "train", first + k // len(scenarios))
        for k in range(recipe.worlds)
    ]


def train(recipe: Recipe, seed: int, say: Say) -> tuple[Learner, int]:
    """The learned table, and how many transitions it took."""
    rng = np.random.default_rng(np.random.SeedSequence([seed]))
    practice = Practice(worlds_of(recipe, seed), recipe.reward)
    say(f"{recipe.worlds} worlds")
    learner = Learner(np.zeros((SITUATIONS, len(MOVES))), recipe.discount)
    steps = 0
    for k in range(recipe.rounds):
        explore, rate = recipe.at(recipe.explore, k), recipe.at(recipe.rate, k)
        steps += practice.run(learner, recipe.decisions, explore, rate, rng)
        practice.restart(recipe.patience)
        if (k + 1) % 50 == 0 or k + 1 == recipe.rounds:
            arrived, hit = practice.outcome()
            say(f"{k + 1}/{recipe.rounds}: {steps} steps, arrived {arrived:.3f}, hit {hit:.3f}")
    return learner, steps


def main(arguments: list[str] | None = None) -> None:
    """Train and write the file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=0, help="of the training")
    parser.add_argument("--rounds", type=int, default=Recipe.rounds, help="of 8 decisions")
    parser.add_argument("--worlds", type=int, default=Recipe.worlds, help="learned in at once")
    parser.add_argument("--out", type=Path, required=True, help="file to write (.safetensors)")
    asked = parser.parse_args(arguments)
    began = process_time()

    def say(text: str) -> None:
        sys.stderr.write(f"{process_time() - began:6.1f} s  {text}\n")

    learner, steps = train(Recipe(asked.rounds, worlds=asked.worlds), asked.seed, say)
    seconds = round(process_time() - began, 1)
    save(asked.out, Table.of(learner, seed=asked.seed, steps=steps, seconds=seconds))
    say(f"wrote {asked.out}")


if __name__ == "__main__":
    main()
