"""The content of tables for people, in every format."""

import math
from collections.abc import Iterator, Sequence
from itertools import groupby

from benchnav.leaderboard.columns import DESCRIPTIVE, MIDDLE_HALF, NAMES, choose
from benchnav.leaderboard.record import ALL, ALL_INTERQUARTILE, PRICES, Leaderboard, Record
from benchnav.leaderboard.rendering.cell import Cell, cell, entrant, heading
from benchnav.leaderboard.rendering.footnotes import with_footnotes
from benchnav.leaderboard.rendering.price_table import LEGENDS as PRICE_LEGENDS
from benchnav.leaderboard.rendering.price_table import price_sections
from benchnav.leaderboard.rendering.section import Section
from benchnav.leaderboard.statistics.order import by_merit, leading
from benchnav.metrics.metric import NOT_APPLICABLE
from benchnav.scenario.condition import condition, described
from benchnav.text.plural import counted

NARROW = 4  # largest number of metrics for which every cell shows its interval
INTERVALS = 2  # metrics that show an interval in a wider table
WIDE = 8  # with more metrics, a table has a row for each of them
PRICED = 3  # of the default metrics that have tables of prices
ABREAST = 5  # navigators side by side in such a table

LEGEND = (
    "value [low, high]: mean over worlds and its 95 % interval; (n): only n episodes define it."
    " ↑ more is better, ↓ less.",
    "rank: the places that an entry may have, by the first metric that ranks. 1–3: no entry is"
    " significantly better, and 2 others tie with it.",
    "Significant: the paired 95 % interval over the worlds excludes 0, after Holm. Scenarios are"
    " fixed: a rank holds for other seeds of these.",
    "Bold: not significantly worse than any other entry; nothing is bold where all tie.",
    "A failed episode counts as the worst: success 0, collided 1.",
)

TRAININGS = (
    "trainings: the least and the most successful of (n) trainings with different seeds, by the"
    " column before. The value is their mean; its interval and ranks hold for these trainings."
)


def sections(
    board: Leaderboard, metrics: Sequence[str] | None, columns: Sequence[str] | None = None
) -> Iterator[Section]:
    """Return the tables of a leaderboard: one per condition, scenario and role, then the prices.

    The table over all scenarios is the first of its condition. ``columns`` are the columns of each
    table, in this order; by default a table shows the rank, the ``metrics``, and the facts about
    navigators in which they differ. A long reason for a missing value becomes a footnote.
    """
    yield from map(with_footnotes, _sections(board, metrics, columns))


def _sections(
    board: Leaderboard, metrics: Sequence[str] | None, columns: Sequence[str] | None
) -> Iterator[Section]:
    named = None if columns is None else [name for name in columns if name in board.metrics]
    shown = choose(board.metrics, metrics if named is None else named)
    records = [r for r in board.records if not r.price]
    groups = {key: list(group) for key, group in groupby(records, key=_key)}
    modes = _modes(board)
    for key, records in sorted(groups.items(), key=lambda item: _overall_first(item[0])):
        if key[2] == ALL_INTERQUARTILE:
            continue
        variants = sum((k[:3], k[6:]) == (key[:3], key[6:]) for k in groups) > 1
        middle = [
            r
            for k, group in groups.items()
            for r in group
            if key[2] == ALL and (k[:3], k[6:]) == ((*key[:2], ALL_INTERQUARTILE), key[6:])
        ]
        table = _Table(records, middle, shown, columns, len(modes) > 1)
        yield from table.sections(_title(records, variants), _name(records[0], variants))
    priced = shown[:PRICED] if metrics is None and columns is None else shown
    yield from price_sections(board, priced)


def legend(board: Leaderboard) -> tuple[str, ...]:
    """Return the lines below all tables."""
    held = {r.price for r in board.records}
    prices = [PRICE_LEGENDS[price] for price in PRICES if price in held]
    caveats = tuple(f"Caveat: {text}" for text in board.caveats)
    modes = _modes(board)
    mode = (f"mode: {modes[0]} for all entries.",) if len(modes) == 1 and modes[0] else ()
    several = (TRAININGS,) if any(r.trainings > 1 for r in board.records) else ()
    return (*LEGEND, *several, *mode, *prices, *caveats)


def _modes(board: Leaderboard) -> list[str]:
    """Return the modes in which the navigators ran, sorted."""
    return sorted({r.mode for r in board.records})


def _overall_first(key: tuple[str, ...]) -> tuple[str, str, bool]:
    split, condition, scenario, *_ = key
    return split, condition, scenario != ALL


def failures_and_remarks(leaders: Sequence[Record]) -> list[str]:
    """Return notes about the failures and remarks of navigators."""
    failures = [f"{r.navigator} failed {_closed(r.failure)}" for r in leaders if r.failure]
    remarks = [f"Remark of {r.navigator} {_closed(r.remark)}" for r in leaders if r.remark]
    return failures + remarks


def granted(rehearsals: int) -> str:
    """Return the note of a table of entries that rehearsed."""
    return (
        f"Granted {counted(rehearsals, 'rehearsal')} of each world before it was scored; ranked"
        " among entries with the same grant alone."
    )


def _key(r: Record) -> tuple[str, ...]:
    """Return the key of a table: condition and scenario follow the split, the grant is last."""
    variant = r.scenario_hash, f"{r.horizon!r}", f"{r.dt!r}"
    where = condition(r.track, r.perception)
    return r.split, where, r.scenario, *variant, r.role, f"{r.rehearsal}"


def _title(records: list[Record], variants: bool) -> str:
    first = records[0]
    scenario = "all scenarios" if first.scenario == ALL else first.scenario
    counts = {r.episodes for r in records if r.episodes}
    worlds = f", {counted(counts.pop(), 'world')}" if len(counts) == 1 else ""
    split = "" if first.split == "test" else f", split {first.split}"
    variant = (
        f", horizon {first.horizon:g} s, dt {first.dt:g} s, hash {first.scenario_hash[:8]}"
        if variants
        else ""
    )
    grant = f", rehearsal: {first.rehearsal}" if first.rehearsal else ""
    where = described(first.track, first.perception)
    return f"{scenario}, {where}{split}, {first.role}s{worlds}{variant}{grant}"


def _name(r: Record, variants: bool) -> tuple[str, ...]:
    """Return the fields that distinguish a table from others of a leaderboard."""
    variant = f"{r.scenario_hash[:8]}-{r.horizon:g}-{r.dt:g}" if variants else ""
    grant = f"rehearsal-{r.rehearsal}" if r.rehearsal else ""
    where = condition(r.track, r.perception)
    return r.scenario, where, r.role, "" if r.split == "test" else r.split, grant, variant


class _Table:
    """The records of one scenario, condition and role, the best navigator first."""

    def __init__(
        self,
        records: list[Record],
        middle: list[Record],
        shown: Sequence[str],
        columns: Sequence[str] | None,
        modes_differ: bool,
    ) -> None:
        self.modes_differ = modes_differ
        self.at = {(r.navigator, r.metric): r for r in records}
        self.middle = {(r.navigator, r.metric): r for r in middle}
        known = {r.metric for r in records}
        self.metrics = [name for name in shown if name in known]
        self.leading = leading(records, self.metrics)
        self.navigators = by_merit({r.navigator: r for r in records if r.metric == self.leading})
        # bold is informative only if a navigator is significantly worse
        self.decided = {r.metric for r in records if (r.rank_low or 0) > 1}
        self.rehearsed = records[0].rehearsal
        self.verified = any(r.verified for r in records)
        self.chapter = described(records[0].track, records[0].perception).capitalize()
        self.columns = [
            name
            for name in (self._usual(records) if columns is None else columns)
            if name in self.metrics or name in NAMES
        ]

    def _usual(self, records: list[Record]) -> Iterator[str]:
        """Yield the default columns: rank and metrics, with facts after the leading metric."""
        yield "rank"
        if self.modes_differ:
            yield "mode"
        for metric in self.metrics:
            yield metric
            if metric != self.leading:
                continue
            if self.middle:
                yield MIDDLE_HALF
            if any(r.trainings > 1 for r in records):
                yield "trainings"
            if any(not math.isnan(r.training_decisions) for r in records):
                yield "training"
            if self.rehearsed:
                yield "rehearsal"
            if self.verified:
                yield "verified"

    def sections(self, title: str, name: tuple[str, ...]) -> Iterator[Section]:
        """Yield a table with a row per navigator; for many metrics, a row per column."""
        if len(self.metrics) <= WIDE:
            rows = [self._row(navigator) for navigator in self.navigators]
            heads = (Cell("navigator"), *map(self._heading, self.columns))
            notes = self._notes(self.navigators)
            yield Section(self.chapter, title, name, heads, tuple(rows), notes)
            return
        columns = [c for c in self.columns if c != MIDDLE_HALF]
        columns.sort(key=lambda column: column in self.metrics)  # stable
        for start in range(0, len(self.navigators), ABREAST):
            block = self.navigators[start : start + ABREAST]
            names = (entrant(self.at[name, self.leading]) for name in block)
            rows = [
                (self._heading(column, alone=True), *(self._cell(n, column, True) for n in block))
                for column in columns
            ]
            heads = (Cell("metric"), *names)
            yield Section(self.chapter, title, name, heads, tuple(rows), self._notes(block))

    def _heading(self, column: str, alone: bool = False) -> Cell:
        if column in self.metrics:
            return heading(next(r for (_, metric), r in self.at.items() if metric == column))
        if column == "rank" and alone:
            return Cell(f"rank ({self.leading})")
        return Cell(column.replace("_", " "))

    def _row(self, name: str) -> tuple[Cell, ...]:
        leader = self.at[name, self.leading]
        limit = len(self.metrics)
        if limit > NARROW:
            limit = INTERVALS - (MIDDLE_HALF in self.columns)
        cells = (self._cell(name, c, c in self.metrics[:limit]) for c in self.columns)
        return entrant(leader), *cells

    def _absence(self, leader: Record, column: str) -> Cell:
        """Return a cell of a navigator that was not run: the leading metric gives the reason."""
        if column in ("rank", "mode"):
            return DESCRIPTIVE[column](leader)
        return Cell(leader.note if column == self.leading else "")

    def _cell(self, name: str, column: str, interval: bool) -> Cell:
        leader = self.at[name, self.leading]
        if not leader.episodes:
            return self._absence(leader, column)
        if column == MIDDLE_HALF:
            return cell(self.middle.get((name, self.leading)), interval=False, decided=False)
        if column in DESCRIPTIVE:
            return DESCRIPTIVE[column](leader)
        r = self.at.get((name, column))
        return cell(r, interval=interval, decided=column in self.decided)

    def _notes(self, names: list[str]) -> tuple[str, ...]:
        leaders = [self.at[name, self.leading] for name in names]
        notes = [
            f"{r.navigator} is not ranked: {r.note}." for r in leaders if r.note and r.episodes
        ]
        notes += failures_and_remarks(leaders)
        notes += [
            f"{metric} of {name} {self.at[name, metric].fault}."
            for name in names
            for metric in self.metrics
            if (name, metric) in self.at
            and self.at[name, metric].fault
            and not self.at[name, metric].fault.startswith(NOT_APPLICABLE)
        ]
        if self.verified:
            notes.append("verified: its runs were re-simulated here; timings cannot be verified.")
        if self.rehearsed:
            notes.append(granted(self.rehearsed))
        return tuple(notes)


def _closed(text: str) -> str:
    return text if text.endswith((".", "!", "?")) else f"{text}."
