"""Simulated tables: worlds with several agents that share their luck, and navigators in them.

Worlds, agents and navigators share their luck through normal numbers that are cut at the rate
(a Gaussian copula).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from benchnav.arrays import FloatArray
from benchnav.leaderboard.statistics.estimate import Column


@dataclass(frozen=True)
class Crowd:
    """How the agents of a simulated world share their luck."""

    name: str
    agents: int  # of each world
    world: float = 0.0  # share of an agent's luck that is the world's, for both navigators
    navigator: float = 0.0  # that is the world's, for each navigator apart
    agent: float = 0.0  # that is its own, for both navigators


CROWDS = (
    Crowd("1 agent", 1),
    Crowd("1 agent, worlds hard for both", 1, world=0.5),
    Crowd("4 agents", 4, world=0.15, navigator=0.1, agent=0.2),
    Crowd("4 agents that share their fate", 4, world=0.3, navigator=0.3, agent=0.2),
    Crowd("10 agents", 10, world=0.15, navigator=0.1, agent=0.2),
)
EACH_FOR_ITSELF = Crowd("4 agents, each for itself", 4)


def world_rates(
    chances: Sequence[float], crowd: Crowd, shape: tuple[int, int], rng: np.random.Generator
) -> list[FloatArray]:
    """World rates (n, T) of one navigator for each of ``chances``, in the same worlds."""
    n, tables = shape
    rest = 1.0 - crowd.world - crowd.navigator - crowd.agent
    world = np.sqrt(crowd.world) * rng.normal(size=(n, 1, tables))
    agent = np.sqrt(crowd.agent) * rng.normal(size=(n, crowd.agents, tables))
    sides = []
    for chance in chances:
        own = np.sqrt(crowd.navigator) * rng.normal(size=(n, 1, tables))
        luck = np.sqrt(rest) * rng.normal(size=(n, crowd.agents, tables))
        sides.append((world + agent + own + luck < ndtri(chance)).mean(axis=1))
    return sides


def unit_rates(tables: int) -> Column:
    """Of ``tables`` columns that are rates."""
    return Column(np.ones(tables, dtype=np.bool_), np.zeros(tables), np.ones(tables))
