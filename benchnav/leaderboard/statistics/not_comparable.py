"""Sentences about results of two navigators that are missing or not comparable, and why."""

from collections.abc import Iterator, Sequence
from itertools import groupby

from benchnav.leaderboard.record import NotApplicable
from benchnav.leaderboard.statistics.strata import Stratum
from benchnav.scenario.condition import condition
from benchnav.text.plural import counted


def absences(
    found: Sequence[Stratum], first: str, second: str, gaps: Sequence[NotApplicable]
) -> list[str]:
    """Return notes on places where one was not run, ran other worlds, failed, or was granted more.

    ``found`` are the strata of only these two navigators.
    """
    notes = [*_single(found, (first, second), gaps), *_uneven(found), *_failed(found)]
    granted = {name: int(n) for s in found for name, n in zip(s.navigators, s.granted, strict=True)}
    if len(set(granted.values())) > 1:
        counts = " and ".join(f"{name} {granted[name] or 'none'}" for name in (first, second))
        notes.append(
            f"Not as equals: of rehearsals of each world {counts} was granted, so neither is called"
            " better, and they are never ranked together."
        )
    return list(dict.fromkeys(notes))  # the strata of several roles give equal notes


def _single(
    found: Sequence[Stratum], names: tuple[str, str], gaps: Sequence[NotApplicable]
) -> Iterator[str]:
    """Yield a sentence per reason about scenarios and conditions in which only one was run."""
    reasons = {(gap.navigator, *_where(gap)): gap.reason for gap in gaps}
    single: list[tuple[str, str, str]] = []  # navigator, reason of the other, place
    for s in found:
        if len(s.navigators) == 2:
            continue
        (name,) = s.navigators
        other = names[name == names[0]]
        reason = reasons.get((other, *_where(s)), "was not run there")
        if any(other in t.navigators and _place(t) == _place(s) for t in found):
            reason = "ran other worlds: horizon, time step or hash differ"
        single.append((name, f"{other} {reason}", _shown(s)))
    for (name, reason), places in groupby(sorted(set(single)), key=lambda row: row[:2]):
        where = ", ".join(place for _, _, place in places)
        yield f"Only {name} in {where}: {reason}."


def _where(of: Stratum | NotApplicable) -> tuple[str, str, str]:
    return of.scenario, of.track, of.perception


def _shown(s: Stratum) -> str:
    return f"{s.scenario} ({condition(s.track, s.perception)})"


def _place(s: Stratum) -> tuple[str, ...]:
    return s.split, s.role, *_where(s)


def _uneven(found: Sequence[Stratum]) -> Iterator[str]:
    """Yield sentences about scenarios in which both were run, but not in the same worlds."""
    for s in found:
        count = s.attempted.sum(axis=0)
        both = int(s.attempted.all(axis=1).sum())
        if len(s.navigators) == 2 and both < count.max():
            counts = " and ".join(f"{n} in {k}" for n, k in zip(s.navigators, count, strict=True))
            yield f"{_shown(s)}: {counts} worlds, compared in the {both} of both."


def _failed(found: Sequence[Stratum]) -> Iterator[str]:
    """Yield sentences about scenarios in which a navigator failed."""
    for s in found:
        if len(s.navigators) < 2:
            continue
        for name, failures in zip(s.navigators, s.failed.sum(axis=0), strict=True):
            if failures:
                yield (
                    f"{_shown(s)}: {name} failed in {counted(failures, 'world')}:"
                    " a failure counts as the worst possible value."
                )
