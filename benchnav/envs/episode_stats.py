"""Counts of the outcomes of attempts, and sums of the reward's terms."""

from collections import Counter, defaultdict
from dataclasses import fields

import numpy as np

from benchnav.envs.agent_batch import Transition
from benchnav.envs.reward import RewardTerms


class Tally:
    """Statistics since the last call of `take`."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()
        self._terms: defaultdict[str, float] = defaultdict(float)

    def add(self, step: Transition) -> None:
        """Add one decision of a batch."""
        self.counts["decisions"] += int(step.acted.sum())
        for name in ("arrived", "touched", "timed_out"):
            self.counts[name] += int(getattr(step, name).sum())
        self._terms["reward"] += float(step.reward.sum())
        for f in fields(RewardTerms):
            self._terms[f.name] += float(np.sum(getattr(step.terms, f.name), where=step.acted))

    def merge(self, other: "Tally") -> None:
        """Add the statistics of other attempts."""
        self.counts.update(other.counts)
        for name, value in other._terms.items():
            self._terms[name] += value

    def take(self) -> dict[str, float]:
        """Return attempts, shares of outcomes, and means of terms per attempt, and reset them."""
        counts, terms = self.counts, self._terms
        attempts = counts["arrived"] + counts["touched"] + counts["timed_out"]
        each = max(attempts, 1)
        row: dict[str, float] = {"decisions": counts["decisions"], "attempts": attempts}
        for name in ("arrived", "touched", "timed_out"):
            row[name] = counts[name] / each
        row |= {name: terms[name] / each for name in terms}
        self.counts, self._terms = Counter(), defaultdict(float)
        return row
