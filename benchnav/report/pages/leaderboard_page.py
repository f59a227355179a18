"""The first page: the leaderboard, in one table that can be sorted and filtered."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

from benchnav.leaderboard.columns import choose
from benchnav.leaderboard.record import ALL, ALL_INTERQUARTILE, Record
from benchnav.leaderboard.rendering.cell import Cell, column, rank, training
from benchnav.leaderboard.rendering.layout import legend
from benchnav.leaderboard.statistics.order import by_merit, leading
from benchnav.report.analysis.best import Best, best_of, more_seeds
from benchnav.report.analysis.view import ROLES, title_of, views_of
from benchnav.report.line_style import LineStyle
from benchnav.report.page import LEADERBOARD, Page
from benchnav.report.report_data import ReportData, family_of
from benchnav.report.template import fill
from benchnav.scenario.terms import PERCEPTIONS
from benchnav.store.runs.spans import count
from benchnav.text.plural import counted

OVERALL = "all scenarios"
_LAST = 1e300  # the sort value of a missing number: it comes after all others


@dataclass(frozen=True)
class Interval:
    """A bar of an interval: percentages of the width of its cell."""

    low: float
    high: float
    value: float


@dataclass(frozen=True)
class MetricCell:
    """A cell with a number."""

    value: str
    bounds: str  # "[0.84, 0.93]"
    order: float
    is_best: bool
    interval: Interval | None


@dataclass(frozen=True)
class Row:
    """A navigator in one scenario, condition and role."""

    navigator: str
    style: LineStyle
    is_verified: bool
    scenario: str  # identity, or `OVERALL`
    page: str  # identity of the scenario; "" for all of them
    variant: str  # what distinguishes it from another row of the same names; "" for nothing
    family: str
    track: str
    perception: str
    role: str
    rank: str  # why there is no result, for a navigator that cannot run here
    rank_order: float
    cells: tuple[MetricCell, ...]
    training: str
    notes: tuple[str, ...]


def pages(data: ReportData) -> Iterator[Page]:
    """Yield the page."""
    rows = tuple(leaderboard_rows(data))
    best = list(_best(data))
    usual = choose(data.metrics, None)
    known = data.values.metrics
    body = fill(
        "leaderboard.html",
        page=LEADERBOARD, rows=rows, legend=legend(replace(data.board, caveats=())),
        caveats=data.board.caveats, usual=usual,
        metrics=[
            (name, known[name].title if name in known else "", _direction(data, name))
            for name in data.metrics
        ],
        filters=[
            ("track", "Track", list(dict.fromkeys(r.track for r in rows)), 0),
            ("perception", "Perception", list(dict.fromkeys(r.perception for r in rows)), 0),
            ("family", "Family", sorted({r.family for r in rows if r.family}), None),
            ("scenario", "Scenario", list(dict.fromkeys(r.scenario for r in rows)), 0),
            ("role", "Role", [role for role in ROLES if role in {r.role for r in rows}], 0),
        ],
        has_training=any(r.training for r in rows),
        best=best, more=list(more_seeds(data.folders)) if any(b.is_tied for _, b in best) else (),
        summary=_summary(data), verification=_verification(data),
        is_exact=data.is_exact, any_verified=any(r.is_verified for r in rows),
    )  # fmt: skip
    yield Page(LEADERBOARD, "Leaderboard", body, LEADERBOARD, has_tables=True)


def _summary(data: ReportData) -> str:
    """Return what the runs consist of, in a sentence."""
    sizes = (
        counted(len(data.navigators), "navigator"), counted(len(data.scenarios), "scenario"),
        f"{counted(len(data.tracks), 'track')} ({', '.join(data.tracks)})",
        *([] if data.is_exact else [f"{' and '.join(data.perceptions)} perception"]),
    )  # fmt: skip
    missing = sum(count(seeds) for folder in data.folders for _, seeds in folder.missing())
    gap = f" The runs are incomplete: {counted(missing, 'episode')} missing." if missing else ""
    return f"{counted(len(data.summaries), 'episode')}: {', '.join(sizes)}.{gap}"


def _verification(data: ReportData) -> str:
    """Return how many navigators have verified results, in a sentence."""
    verified = [name for name in data.navigators if name in data.values.verified]
    if not verified:
        return "The results were not verified."
    if len(verified) == len(data.navigators):
        return "All results were verified on the machine that made this report."
    return f"The results of {', '.join(verified)} were verified."


def leaderboard_rows(data: ReportData) -> Iterator[Row]:
    """Yield the rows, the mean over scenarios first, the best navigator of each group first."""
    groups = _groups(data)
    names = [_names(group[0]) for group in groups]
    for group, name in zip(groups, names, strict=True):
        yield from _rows(data, group, is_unique=names.count(name) == 1)


def _groups(data: ReportData) -> list[list[Record]]:
    """Return the records that are ranked together; first those over all scenarios."""
    records = [r for r in data.board.records if not r.price]
    records = [r for r in records if r.scenario != ALL_INTERQUARTILE]
    order = {track: place for place, track in enumerate(data.tracks)}
    records.sort(
        key=lambda r: (
            r.split, order.get(r.track, len(order)), PERCEPTIONS.index(r.perception),
            r.scenario != ALL,
        )
    )  # fmt: skip
    return [list(group) for _, group in groupby(records, key=_key)]


def _best(data: ReportData) -> Iterator[tuple[str, Best]]:
    """Yield the title of each view and its best navigators, over all scenarios or in its first."""
    groups = _groups(data)
    views = views_of(r for group in groups for r in group)
    for view in views:
        group = next(group for group in groups if view.holds(group[0]))
        lead = leading(group, [m for m in data.metrics if any(r.metric == m for r in group)])
        leaders = {r.navigator: r for r in group if r.metric == lead}
        best = best_of([leaders[name] for name in by_merit(leaders)])
        if best is not None:
            where = "" if group[0].scenario == ALL else f", {group[0].scenario}"
            yield f"{title_of(view, views)}{where}", best


def _key(r: Record) -> tuple[object, ...]:
    """Return the key of navigators that are ranked together."""
    horizon = "" if math.isnan(r.horizon) else f"{r.horizon} {r.dt}"
    where = r.track, r.perception, r.scenario, r.scenario_hash
    return r.split, *where, horizon, r.role, r.rehearsal


def _names(r: Record) -> tuple[str, ...]:
    return r.track, r.perception, r.scenario, r.role


def _rows(data: ReportData, group: Sequence[Record], is_unique: bool) -> Iterator[Row]:
    at = {(r.navigator, r.metric): r for r in group}
    held = [name for name in data.metrics if any(key[1] == name for key in at)]
    lead = leading(group, held)
    scales = {name: _scale(data, [r for r in group if r.metric == name]) for name in held}
    decided = {r.metric for r in group if (r.rank_low or 0) > 1}
    ordered = by_merit({r.navigator: r for r in group if r.metric == lead})
    texts = {m: column([at.get((name, m)) for name in ordered], decided=m in decided) for m in held}
    for place, navigator in enumerate(ordered):
        r = at[navigator, lead]
        whole = r.scenario == ALL
        yield Row(
            navigator=navigator, style=data.styles[navigator],
            is_verified=any(at[navigator, m].verified for m in held if (navigator, m) in at),
            scenario=OVERALL if whole else r.scenario, page="" if whole else r.scenario,
            variant="" if is_unique else _variant(r),
            family="" if whole else family_of(r.scenario), track=r.track,
            perception=r.perception, role=r.role,
            rank=rank(r).text if r.episodes else r.note,
            rank_order=_LAST if r.rank_low is None else r.rank_low,
            cells=tuple(
                _cell(at[navigator, m], texts[m][place], scales[m])
                if (navigator, m) in at
                else MetricCell("", "", _LAST, False, None)
                for m in data.metrics
            ),
            training=training(r).text,
            notes=tuple(_notes([at[navigator, m] for m in held if (navigator, m) in at], r)),
        )  # fmt: skip


def _variant(r: Record) -> str:
    parts = [] if r.split == "test" else [f"split {r.split}"]
    if r.scenario_hash:
        parts.append(f"horizon {r.horizon:g} s, dt {r.dt:g} s, hash {r.scenario_hash[:8]}")
    parts += [f"rehearsals: {r.rehearsal}"] if r.rehearsal else []
    return ", ".join(parts)


def _scale(data: ReportData, records: Sequence[Record]) -> tuple[float, float]:
    """Return the numbers at the left and right end of the bars of a metric in one group."""
    metric = data.values.metrics.get(records[0].metric)
    if metric is not None and metric.rate:
        return 0.0, 1.0
    ends = [x for r in records for x in (r.value, r.low, r.high) if not math.isnan(x)]
    return min([0.0, *ends]), max([0.0, *ends])


def _cell(r: Record, shown: Cell, scale: tuple[float, float]) -> MetricCell:
    if not r.episodes or math.isnan(r.value):
        missing = -_LAST if r.better == "higher" else _LAST
        return MetricCell("–" if r.episodes else "", "", missing, False, None)
    low, high = (r.value, r.value) if math.isnan(r.low) else (r.low, r.high)
    bar = _interval(low, high, r.value, scale)
    return MetricCell(*_split(shown.text), r.value, shown.bold, bar)


def _split(text: str) -> tuple[str, str]:
    """Return ``16.6 s (96)`` and ``[16.2, 17.0]`` of ``16.6 [16.2, 17.0] s (96)``."""
    value, bracket, rest = text.partition(" [")
    bounds, end, unit = rest.partition("]")
    return value + unit, f"[{bounds}]" if bracket and end else ""


def _interval(low: float, high: float, value: float, scale: tuple[float, float]) -> Interval:
    first, width = scale[0], (scale[1] - scale[0]) or 1.0
    return Interval(*(round(100.0 * (x - first) / width, 1) for x in (low, high, value)))


def _notes(records: Sequence[Record], lead: Record) -> Iterator[str]:
    """Yield why there is no rank, failures of the navigator, and its remarks."""
    if not lead.episodes:
        return
    if lead.note:
        yield f"not ranked: {lead.note}"
    if lead.failures:
        yield f"failed {lead.failure or f'in {lead.failures} episodes'}"
    if lead.remark:
        yield f"remark {lead.remark}"
    yield from dict.fromkeys(f"{r.metric} {r.fault}" for r in records if r.fault)
    if lead.mode == "isolated":
        yield "ran in its own process"


def _direction(data: ReportData, name: str) -> str:
    metric = data.values.metrics.get(name)
    return {"higher": "↑", "lower": "↓", None: ""}[metric.better if metric else None]
