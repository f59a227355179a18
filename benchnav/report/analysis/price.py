"""Prices in words: how much a navigator gains by a map, or loses by noise."""

from collections.abc import Iterable
from dataclasses import dataclass

from benchnav.leaderboard.record import ALL, IGNORANCE, NO_MAP, NOISE, Price, Record
from benchnav.leaderboard.rendering.cell import cell
from benchnav.metrics.metric import Metric
from benchnav.scenario.condition import EXACT, described


@dataclass(frozen=True)
class Words:
    """The words about a price."""

    question: str
    unknown: str  # if the runs hold no price
    change: str  # from the second to the first side
    above: str  # the first side is better
    below: str


WORDS = {
    IGNORANCE: Words(
        "How much does a map help? Each navigator ran in the same worlds twice: once with a"
        " complete map of walls and static obstacles (track known), and once without any map"
        " (track unknown). The price of ignorance is the difference, known − unknown, in each"
        " world, averaged.",
        "It is the gain by a map. These runs cannot tell: they hold no scenario of this navigator"
        " in both tracks, known and unknown.",
        "with the map", "the map helps", "the map harms",
    ),
    NOISE: Words(
        "How much does noise cost? Each navigator ran in the same worlds twice: once with exact"
        " perception, and once with the noise of its sensors (noisy perception). The price of"
        " noise is the difference, exact − noisy, in each world, averaged.",
        "It is the loss by the noise of sensors. These runs cannot tell: they hold no scenario of"
        " this navigator with both perceptions, exact and noisy.",
        "without noise", "noise harms", "noise helps",
    ),
}  # fmt: skip


def prices_of(
    records: Iterable[Record], navigator: str, metric: str, price: Price = IGNORANCE
) -> list[Record]:
    """Return the prices of one navigator by one metric, the mean over all scenarios first."""
    found = [
        r for r in records
        if (r.price, r.navigator, r.metric) == (price, navigator, metric)
    ]  # fmt: skip
    found.sort(key=lambda r: (r.split, price.other(r), r.role, r.scenario != ALL, r.scenario))
    return found


def price_sentence(record: Record, metric: Metric) -> str:
    """Return a sentence about one price."""
    words = WORDS[record.price or IGNORANCE]
    where = "Over all scenarios" if record.scenario == ALL else f"In {record.scenario}"
    where += _other(record)
    role = f", {record.role}s" if record.role != "leader" else ""
    if record.note == NO_MAP:
        return f"{where}{role}: it uses no map, so a map changes nothing."
    if not record.episodes:
        return f"{where}{role}: no value, {record.note}."
    change = f"{metric.name} changes by {cell(record, interval=True, decided=False).text}"
    note = f" ({record.note})" if record.note else ""
    return f"{where}{role}: {words.change}, {change}{_judged(record, words)}{note}."


def _other(record: Record) -> str:
    """Return the rest of the condition, unless nothing but exact perception is meant."""
    if record.price == NOISE:
        return f", {described(record.track, EXACT)}"
    return "" if record.perception == EXACT else f", {record.perception} perception"


def _judged(record: Record, words: Words) -> str:
    """Return which side is better, as far as the interval shows it."""
    if record.low != record.low:
        return ""
    if record.low <= 0.0 <= record.high:
        return "; that may be chance"
    if record.better is None:
        return ""
    above = (record.value > 0) == (record.better == "higher")
    return f"; {words.above if above else words.below}"
