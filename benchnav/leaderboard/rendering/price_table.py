"""The tables of prices: a row for each navigator, a column for each scenario."""

from collections.abc import Iterator, Sequence
from itertools import groupby

from benchnav.leaderboard.record import (
    ALL,
    IGNORANCE,
    NO_MAP,
    NOISE,
    PRICES,
    Leaderboard,
    Price,
    Record,
)
from benchnav.leaderboard.rendering.cell import Cell, cell
from benchnav.leaderboard.rendering.section import Section
from benchnav.scenario.condition import EXACT
from benchnav.text.plural import counted

ABREAST = 5  # columns of numbers side by side
LEGENDS = {
    IGNORANCE: "price of ignorance: what the same navigator reaches in track known less what it"
    " reaches in track unknown, mean over the same worlds [95 % interval]. It does not rank.",
    NOISE: "price of noise: what the same navigator reaches with exact perception less what it"
    " reaches with noisy perception, mean over the same worlds [95 % interval]. It does not rank.",
}

Place = tuple[bool, str, str, float, float]


def price_sections(board: Leaderboard, shown: Sequence[str]) -> Iterator[Section]:
    """Yield a table for each price, metric of ``shown`` that has a better side, role and grant."""
    for price in PRICES:

        def contest(r: Record, price: Price = price) -> tuple[str, str, str, int]:
            return r.split, price.other(r), r.role, r.rehearsal

        priced = sorted((r for r in board.records if r.price == price), key=contest)  # stable
        for _, group in groupby(priced, key=contest):
            records = list(group)
            for metric in shown:
                chosen = [r for r in records if r.metric == metric and r.better]
                if chosen:
                    yield from _tables(price, chosen)


def difference(price: Price, r: Record) -> str:
    """Return ``known − unknown``, and the other part of the condition unless it is exact."""
    sides = f"{price.first} − {price.second}"
    if price.axis == "perception":
        return f"{sides}, track {r.track}"
    return sides if r.perception == EXACT else f"{sides}, {r.perception} perception"


def _tables(price: Price, records: list[Record]) -> Iterator[Section]:
    """Yield the tables of one metric, each with at most `ABREAST` scenarios."""
    first = records[0]
    at = {(r.navigator, _place(r)): r for r in records}
    places = sorted({_place(r) for r in records})
    names = sorted({r.navigator for r in records}, key=lambda name: _bare(at, name, places))
    counts = {r.episodes for r in records if r.episodes and r.scenario != ALL}
    title = f"{first.metric}, {difference(price, first)}, {first.role}s"
    title += f", {counted(counts.pop(), 'world')}" if len(counts) == 1 else ""
    title += "" if first.split == "test" else f", split {first.split}"
    title += f", rehearsal: {first.rehearsal}" if first.rehearsal else ""
    name = (
        *price_name(price, first), first.metric, first.role,
        "" if first.split == "test" else first.split,
    )  # fmt: skip
    for start in range(0, len(places), ABREAST):
        block = places[start : start + ABREAST]
        heads = [Cell("all scenarios" if p[1] == ALL else p[1]) for p in block]
        rows = [(Cell(name), *_row([at.get((name, p)) for p in block])) for name in names]
        yield Section(
            price.name.capitalize(), title, name, (Cell("navigator"), *heads), tuple(rows), ()
        )


def price_name(price: Price, r: Record) -> tuple[str, ...]:
    """Return the fields that distinguish the tables of a price from all others."""
    if price.axis == "perception":
        return "noise", r.track
    return "price", "" if r.perception == EXACT else r.perception


def _place(r: Record) -> Place:
    """Return the sort key of a column: the mean over all scenarios is first."""
    whole = r.scenario == ALL
    variant = (0.0, 0.0) if whole else (r.horizon, r.dt)
    return not whole, r.scenario, r.scenario_hash, *variant


def _bare(at: dict[tuple[str, Place], Record], name: str, places: list[Place]) -> tuple[bool, str]:
    """Return the sort key of a row: navigators without a price are last."""
    found = [at[name, p] for p in places if (name, p) in at]
    return all(r.note == NO_MAP or not r.episodes for r in found), name


def _row(records: Sequence[Record | None]) -> Iterator[Cell]:
    """Yield numbers, or the reason for none; a reason of all is given once."""
    reasons = {r.note for r in records if r and (r.note == NO_MAP or not r.episodes)}
    alike = len(reasons) == 1 and all(r and r.note in reasons for r in records)
    for k, r in enumerate(records):
        if r and (r.note == NO_MAP or not r.episodes):
            yield Cell(r.note if k == 0 or not alike else "")
        else:
            yield cell(r, interval=True, decided=False)
