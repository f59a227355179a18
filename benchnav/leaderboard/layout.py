"""What a table for people shows, whatever it is printed as."""

import math
from collections.abc import Iterator, Sequence
from itertools import groupby

from benchnav.errors import UsageError, did_you_mean
from benchnav.leaderboard.cell import (
    Cell,
    cell,
    entrant,
    heading,
    rank,
    rehearsal,
    training,
    verified,
)
from benchnav.leaderboard.price_table import LEGEND as PRICE_LEGEND
from benchnav.leaderboard.price_table import price_sections
from benchnav.leaderboard.record import ALL, ALL_INTERQUARTILE, PRICE, Leaderboard, Record
from benchnav.leaderboard.section import Section

DEFAULT = ("success", "collided", "spl", "time_to_goal", "turning", "latency_p50")
NARROW = 4  # metrics up to which every cell shows its interval
INTERVALS = 2  # metrics that show it in a wider table
WIDE = 8  # metrics beyond which a table has a row for each of them
PRICED = 3  # of the default metrics that have a table of the price of ignorance
ABREAST = 5  # navigators side by side in such a table

LEGEND = (
    "value [low, high]: mean over worlds and its 95 % interval; (n): only n episodes define it."
    " ↑ more is better, ↓ less.",
    "rank: 1 + entries significantly better – N − entries significantly worse, by the first metric"
    " that ranks; 1–3 is a tie.",
    "Significant: the paired 95 % interval over the worlds excludes 0, after Holm. Scenarios are"
    " fixed: a rank holds for other seeds of these.",
    "Bold: not significantly worse than any other entry; nothing is bold where all tie.",
    "A failed episode counts as the worst: success 0, collided 1.",
)


def choose(held: Sequence[str], metrics: Sequence[str] | None) -> tuple[str, ...]:
    """The metrics to show of those ``held``: the default few, ``["all"]``, or those named.

    Raises UsageError for a metric that is not held.
    """
    if metrics is None:
        return tuple(name for name in DEFAULT if name in held) or tuple(held[:NARROW])
    if list(metrics) == ["all"]:
        return tuple(held)
    for name in metrics:
        if name not in held:
            raise UsageError(
                f"A metric to show must be one that the leaderboard holds. Got {name!r} instead."
                f"{did_you_mean(name, held)} 'all' shows all."
            )
    return tuple(dict.fromkeys(metrics))


def sections(board: Leaderboard, metrics: Sequence[str] | None) -> Iterator[Section]:
    """Tables of a leaderboard, one per track, scenario and role, and what ignorance costs."""
    shown = choose(board.metrics, metrics)
    records = [r for r in board.records if r.track != PRICE]
    groups = {key: list(group) for key, group in groupby(records, key=_key)}
    for key, records in groups.items():
        if key[2] == ALL_INTERQUARTILE:
            continue
        variants = sum((k[:3], k[6:]) == (key[:3], key[6:]) for k in groups) > 1
        middle = [
            r
            for k, group in groups.items()
            for r in group
            if key[2] == ALL and (k[:3], k[6:]) == ((*key[:2], ALL_INTERQUARTILE), key[6:])
        ]
        yield from _Table(records, middle, shown).sections(_title(records, variants))
    yield from price_sections(board, shown[:PRICED] if metrics is None else shown)


def legend(board: Leaderboard) -> tuple[str, ...]:
    """What is said below all tables."""
    priced = any(r.track == PRICE for r in board.records)
    return (*LEGEND, PRICE_LEGEND) if priced else LEGEND


def _key(r: Record) -> tuple[str, ...]:
    """What stands in one table: the scenario is third, role and grant last."""
    variant = r.scenario_hash, f"{r.horizon!r}", f"{r.dt!r}"
    return r.split, r.track, r.scenario, *variant, r.role, f"{r.rehearsal}"


def _title(records: list[Record], variants: bool) -> str:
    first = records[0]
    scenario = "all scenarios" if first.scenario == ALL else first.scenario
    counts = {r.episodes for r in records if r.episodes}
    worlds = f", {counts.pop()} worlds" if len(counts) == 1 else ""
    split = "" if first.split == "test" else f", split {first.split}"
    variant = (
        f", horizon {first.horizon:g} s, dt {first.dt:g} s, hash {first.scenario_hash[:8]}"
        if variants
        else ""
    )
    grant = f", rehearsal: {first.rehearsal}" if first.rehearsal else ""
    return f"{scenario}, track {first.track}{split}, {first.role}s{worlds}{variant}{grant}"


class _Table:
    """The records of one scenario, track and role, the best navigator first."""

    def __init__(self, records: list[Record], middle: list[Record], shown: Sequence[str]) -> None:
        self.at = {(r.navigator, r.metric): r for r in records}
        self.middle = {(r.navigator, r.metric): r for r in middle}
        known = {r.metric for r in records}
        self.metrics = [name for name in shown if name in known]
        ranked = {r.metric for r in records if r.ranked}
        self.leading = next((name for name in self.metrics if name in ranked), self.metrics[0])
        self.navigators = sorted({r.navigator for r in records})
        self.navigators.sort(key=lambda name: _merit(self.at[name, self.leading]))
        # bold says something only where somebody is significantly worse
        self.decided = {r.metric for r in records if (r.rank_low or 0) > 1}
        self.learned = any(not math.isnan(r.training_decisions) for r in records)
        self.rehearsed = records[0].rehearsal
        self.verified = any(r.verified for r in records)
        self.chapter = f"Track {records[0].track}"
        self.moded = any(r.mode for r in records)

    def sections(self, title: str) -> Iterator[Section]:
        """A row for each navigator, or for each metric where those are many."""
        if len(self.metrics) <= WIDE:
            wide = tuple(self._navigator(name) for name in self.navigators)
            yield Section(
                self.chapter, title, tuple(self._headings()), wide, self._notes(self.navigators)
            )
            return
        for start in range(0, len(self.navigators), ABREAST):
            block = self.navigators[start : start + ABREAST]
            names = tuple(entrant(self.at[name, self.leading]) for name in block)
            ranks = tuple(rank(self.at[name, self.leading]) for name in block)
            rows = [tuple(self._metric(metric, block)) for metric in self.metrics]
            if self.learned:
                costs = (training(self.at[name, self.leading]) for name in block)
                rows.insert(0, (Cell("training"), *costs))
            if self.verified:
                marks = (verified(self.at[name, self.leading]) for name in block)
                rows.insert(0, (Cell("verified"), *marks))
            if self.rehearsed:
                spent = (rehearsal(self.at[name, self.leading]) for name in block)
                rows.insert(0, (Cell("rehearsal"), *spent))
            if self.moded:
                modes = (Cell(self.at[name, self.leading].mode) for name in block)
                rows.insert(0, (Cell("mode"), *modes))
            rows.insert(0, (Cell(f"rank ({self.leading})"), *ranks))
            yield Section(
                self.chapter, title, (Cell("metric"), *names), tuple(rows), self._notes(block)
            )

    def _headings(self) -> Iterator[Cell]:
        yield from (Cell("navigator"), Cell("rank"))
        if self.moded:
            yield Cell("mode")  # in the runner's process, or in one of its own
        for metric in self.metrics:
            yield heading(self._any(metric))
            if self.middle and metric == self.leading:
                yield Cell("middle half")  # interquartile mean over scenarios
            if self.learned and metric == self.leading:
                yield Cell("training")  # decisions and time
            if self.rehearsed and metric == self.leading:
                yield Cell("rehearsal")  # decisions and time in one world
            if self.verified and metric == self.leading:
                yield Cell("verified")  # re-simulated here

    def _navigator(self, name: str) -> tuple[Cell, ...]:
        leader = self.at[name, self.leading]
        row = [entrant(leader), rank(leader), *([Cell(leader.mode)] if self.moded else [])]
        if not leader.episodes:
            extra = bool(self.middle) + self.learned + bool(self.rehearsed) + self.verified
            blank = [Cell("")] * (len(self.metrics) - 1 + extra)
            return (*row, Cell(leader.note), *blank)
        wide = len(self.metrics) > NARROW
        limit = INTERVALS - bool(self.middle) if wide else len(self.metrics)
        for place, metric in enumerate(self.metrics):
            row.append(self._cell(name, metric, place < limit))
            if self.middle and metric == self.leading:
                inner = self.middle.get((name, metric))
                row.append(cell(inner, interval=False, decided=False))
            if self.learned and metric == self.leading:
                row.append(training(leader))
            if self.rehearsed and metric == self.leading:
                row.append(rehearsal(leader))
            if self.verified and metric == self.leading:
                row.append(verified(leader))
        return tuple(row)

    def _metric(self, metric: str, block: list[str]) -> tuple[Cell, ...]:
        return heading(self._any(metric)), *(self._cell(name, metric, True) for name in block)

    def _cell(self, name: str, metric: str, interval: bool) -> Cell:
        r = self.at.get((name, metric))
        return cell(r, interval=interval, decided=metric in self.decided)

    def _any(self, metric: str) -> Record:
        return next(r for (_, name), r in self.at.items() if name == metric)

    def _notes(self, names: list[str]) -> tuple[str, ...]:
        leaders = [self.at[name, self.leading] for name in names]
        notes = [
            f"{r.navigator} is not ranked: {r.note}." for r in leaders if r.note and r.episodes
        ]
        notes += [
            f"{metric} of {name} {self.at[name, metric].fault}."
            for name in names
            for metric in self.metrics
            if (name, metric) in self.at and self.at[name, metric].fault
        ]
        if self.verified:
            notes.append("verified: its runs were re-simulated here; timings cannot be verified.")
        if self.rehearsed:
            notes.append(
                f"Granted {self.rehearsed} rehearsals of each world before it was scored; ranked"
                " among entries with the same grant alone."
            )
        return tuple(notes)


def _merit(r: Record) -> tuple[float, float, float]:
    """Ranked before unranked before absent; then by value."""
    if r.rank_low is None or r.rank_high is None:
        ranks = (math.inf, math.inf if math.isnan(r.value) else 0.0)
    else:
        ranks = (float(r.rank_low), float(r.rank_high))
    value = 0.0 if math.isnan(r.value) else r.value
    return (*ranks, value if r.better == "lower" else -value)
