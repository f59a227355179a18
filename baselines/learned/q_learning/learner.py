"""The update of tabular Q-learning for many transitions at once.

Watkins & Dayan (1992), "Q-learning", Machine Learning 8: Q(s, a) moves towards
r + γ max Q(s', ·), or towards r if the episode ended. Transitions of one step that
share (s, a) count by the mean of their targets (an addition), which makes the
result independent of their order.
"""

from dataclasses import dataclass, field

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray


@dataclass
class Learner:
    """A table of values, and the number of updates of each."""

    values: FloatArray  # (S, U)
    discount: float  # γ, per decision
    visits: IntArray = field(init=False)  # (S, U) number of transitions

    def __post_init__(self) -> None:
        self.visits = np.zeros(self.values.shape, np.int64)

    def update(
        self, state: IntArray, action: IntArray, reward: FloatArray, after: IntArray,
        ended: BoolArray, rate: float,
    ) -> None:  # fmt: skip
        """Learn from N transitions.

        Args:
            state: (N,) situation before.
            action: (N,) the chosen move.
            reward: (N,) of the move.
            after: (N,) situation afterwards.
            ended: (N,) whether the attempt ended.
            rate: step size for one transition; n of them move the value by 1 - (1 - rate)^n,
                and the first transition sets the value.
        """
        target = reward + self.discount * np.where(ended, 0.0, self.values[after].max(axis=1))
        cell, where = np.unique(state * self.values.shape[1] + action, return_inverse=True)
        count = np.bincount(where, minlength=len(cell))
        mean = np.bincount(where, weights=target, minlength=len(cell)) / count
        values, visits = self.values.reshape(-1), self.visits.reshape(-1)
        visits[cell] += count
        share = np.maximum(1.0 - (1.0 - rate) ** count, count / visits[cell])
        values[cell] += share * (mean - values[cell])


def chosen(
    values: FloatArray, state: IntArray, explore: float, rng: np.random.Generator
) -> IntArray:
    """Return the greedy action (N,) in each state, or a random one with probability ``explore``."""
    best = values[state].argmax(axis=1)
    anything = rng.integers(values.shape[1], size=len(state))
    return np.where(rng.random(len(state)) < explore, anything, best)
