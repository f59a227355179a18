"""One metric at a glance: a row for each navigator, a column for each scenario."""

from collections.abc import Iterator, Sequence
from itertools import groupby

from benchnav.leaderboard.record import (
    ALL,
    ALL_INTERQUARTILE,
    NO_MAP,
    PRICES,
    Leaderboard,
    Record,
)
from benchnav.leaderboard.rendering.cell import Cell, cell, entrant, rank, rehearsal, training
from benchnav.leaderboard.rendering.layout import failures_and_remarks, granted
from benchnav.leaderboard.rendering.price_table import price_name
from benchnav.leaderboard.rendering.section import Section
from benchnav.leaderboard.statistics.order import by_merit
from benchnav.scenario.condition import condition, described
from benchnav.text.plural import counted

Place = tuple[bool, str, str, float, float]
BETTER = {"higher": " (higher is better)", "lower": " (lower is better)", None: ""}
INTERVAL = "95 % interval"


def matrix_sections(board: Leaderboard, metrics: Sequence[str]) -> Iterator[Section]:
    """Yield a matrix per metric, condition, role, split and grant; then the prices."""
    for price in (None, *PRICES):
        records = [r for r in board.records if r.price == price]
        records = [r for r in records if r.scenario != ALL_INTERQUARTILE]
        for metric in metrics:
            chosen = sorted((r for r in records if r.metric == metric), key=_contest)  # stable
            for _, group in groupby(chosen, key=_contest):
                section = _matrix(list(group))
                if section.rows:
                    yield section


def _contest(r: Record) -> tuple[str, str, str, str, int]:
    return r.split, r.track, r.perception, r.role, r.rehearsal


def _place(r: Record) -> Place:
    """Return the sort key of a column: the mean over scenarios is first."""
    whole = r.scenario == ALL
    variant = (0.0, 0.0) if whole else (r.horizon, r.dt)
    return not whole, r.scenario, r.scenario_hash, *variant


def _matrix(records: list[Record]) -> Section:
    at = {(r.navigator, _place(r)): r for r in records}
    places = sorted({_place(r) for r in records})
    first, wide = records[0], places[0]  # the column with intervals
    leaders = {r.navigator: r for r in records if _place(r) == wide}
    leaders = {r.navigator: leaders.get(r.navigator, r) for r in records}
    priced = first.price is not None
    idle = {r.navigator for r in leaders.values() if priced and r.note == NO_MAP}
    names = [name for name in by_merit(leaders) if name not in idle]
    worse = {_place(r) for r in records if (r.rank_low or 0) > 1}
    rows = []
    for name in names:
        row = [entrant(leaders[name]), *([] if priced else [rank(leaders[name])])]
        missing = None if leaders[name].episodes else leaders[name]
        row += [_cell(at.get((name, p), missing), p == wide, p in worse) for p in places]
        rows.append(tuple(row))
    heads = [Cell("navigator"), *([] if priced else [Cell("rank")])]
    heads += [Cell(_heading(p, places)) for p in places]
    notes = _notes([leaders[name] for name in names], idle)
    return Section("", _title(records, places), _name(first), tuple(heads), tuple(rows), notes)


def _cell(r: Record | None, interval: bool, decided: bool) -> Cell:
    if r is not None and not r.episodes:
        return Cell("n/a")
    return cell(r, interval=interval, decided=decided)


def _heading(place: Place, places: Sequence[Place]) -> str:
    """Return the scenario, with hash, horizon and time step if another column has the same name."""
    if not place[0]:
        return "all scenarios"
    _, scenario, digest, horizon, dt = place
    unique = sum(other[1] == scenario for other in places) == 1
    return scenario if unique else f"{scenario} {digest[:8]} {horizon:g} s {dt:g} s"


def _title(records: Sequence[Record], places: Sequence[Place]) -> str:
    """Return the caption: the metric, the agents, the condition, and what the numbers mean."""
    first = records[0]
    where = _where(first)
    where += "" if first.split == "test" else f", split {first.split}"
    where += f", {counted(first.rehearsal, 'rehearsal')} granted" if first.rehearsal else ""
    counts = {r.episodes for r in records if r.episodes and r.scenario != ALL}
    worlds = counted(counts.pop(), "world") if len(counts) == 1 else "the worlds"
    several = f"each scenario, and over all scenarios with {INTERVAL}"
    of = several if len(places) > 1 else f"{places[0][1]}, with {INTERVAL}"
    better = "" if first.price else BETTER[first.better]
    return f"{first.metric}{better} of {first.role}s, {where}: means over {worlds} of {of}"


def _where(r: Record) -> str:
    """Return the condition; for a price both sides of it."""
    if r.price is None:
        return described(r.track, r.perception)
    return " less ".join(described(*side) for side in r.price.sides(r))


def _name(r: Record) -> tuple[str, ...]:
    where = price_name(r.price, r) if r.price else (condition(r.track, r.perception),)
    grant = f"rehearsal-{r.rehearsal}" if r.rehearsal else ""
    return r.metric, *where, r.role, "" if r.split == "test" else r.split, grant


def _notes(leaders: Sequence[Record], idle: set[str]) -> tuple[str, ...]:
    """Return notes, with each reason for no number or no rank once for all of its navigators."""
    reasons: dict[str, list[str]] = {}
    for r in leaders:
        if r.note and not r.episodes:
            reasons.setdefault(r.note, []).append(r.navigator)
        elif r.note and not r.price:
            reasons.setdefault(f"not ranked ({r.note})", []).append(r.navigator)
    notes = [f"{reason}: {', '.join(names)}." for reason, names in reasons.items()]
    notes += failures_and_remarks([r for r in leaders if not r.price])
    notes += [f"{r.metric} of {r.navigator} {r.fault}." for r in leaders if r.fault]
    if idle:
        notes.append(f"{NO_MAP}, so that there is no difference: {', '.join(sorted(idle))}.")
    return (*notes, *_costs(leaders))


def _costs(leaders: Sequence[Record]) -> Iterator[str]:
    """Yield notes about training, rehearsals and verification: columns in other formats."""
    for title, cost in (("training", training), ("rehearsal of a world", rehearsal)):
        spent = [f"{r.navigator} {text}" for r in leaders if (text := cost(r).text)]
        if spent:
            yield f"{title}: {'; '.join(spent)}."
    if leaders and leaders[0].rehearsal:
        yield granted(leaders[0].rehearsal)
    checked = [r.navigator for r in leaders if r.verified]
    if checked:
        yield f"verified, re-simulated here: {', '.join(checked)}."
