"""Failures by cause, and by the obstacle, wall or agent that was hit."""

from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from benchnav.report.analysis.episode_summary import EpisodeSummary
from benchnav.report.analysis.outcome import Outcome
from benchnav.report.analysis.partner import without_number
from benchnav.report.analysis.view import View
from benchnav.text.plural import counted


@dataclass(frozen=True)
class OutcomeShares:
    """The outcomes of one navigator, scenario by scenario or over some."""

    worlds: int
    shares: tuple[float, ...]  # of agents per `Outcome`, mean over worlds; they add up to 1

    def __getitem__(self, outcome: Outcome) -> float:
        return self.shares[outcome]


def outcome_shares(
    summaries: Iterable[EpisodeSummary], view: View
) -> dict[str, dict[str, OutcomeShares]]:
    """Return scenario → navigator → shares of outcomes in a view. A repeated episode counts once.

    The share of `Outcome.SUCCESS` is the mean of the metric `success`.
    """
    worlds: dict[tuple[str, str], dict[int, tuple[float, ...]]] = {}
    for summary in summaries:
        if _is_in(summary, view):
            shares = dict(summary.shares).get(view.role)
            if shares is not None:
                key = summary.scenario, summary.navigator
                worlds.setdefault(key, {})[summary.seed] = shares
    found: dict[str, dict[str, OutcomeShares]] = {}
    for (scenario, navigator), each in worlds.items():
        mean = np.mean([each[seed] for seed in sorted(each)], axis=0)
        found.setdefault(scenario, {})[navigator] = OutcomeShares(len(each), tuple(mean.tolist()))
    return found


def partners(
    summaries: Iterable[EpisodeSummary], view: View, most: int, fixed: Collection[str]
) -> dict[str, Mapping[str, int]]:
    """Return name of the obstacle, wall or team → navigator → number of agents that hit it.

    Obstacles and walls that are not ``fixed`` differ from seed to seed: those of a kind are added
    up. Only the ``most`` frequent ones, the most frequent first; the others are added up.
    """
    seen = set()
    counts: dict[str, Counter[str]] = {}
    for s in summaries:
        key = s.scenario, s.navigator, s.seed
        if not _is_in(s, view) or key in seen:
            continue
        seen.add(key)
        for collision in s.collisions:
            if collision.role == view.role:
                name = collision.partner
                name = name if name in fixed else without_number(name)
                counts.setdefault(name, Counter())[s.navigator] += 1
    ordered = sorted(counts, key=lambda name: (-counts[name].total(), name))
    found: dict[str, Mapping[str, int]] = {name: counts[name] for name in ordered[:most]}
    if rest := ordered[most:]:
        found[counted(len(rest), "other")] = sum((counts[name] for name in rest), Counter[str]())
    return found


def _is_in(summary: EpisodeSummary, view: View) -> bool:
    return view.track in summary.tracks and (view.split, view.perception) == (
        summary.split,
        summary.perception,
    )
