"""The price of ignorance in words: how much a navigator gains by the map of its world."""

from collections.abc import Iterable, Mapping

from benchnav.leaderboard.record import ALL, NO_MAP, PRICE, Record
from benchnav.leaderboard.rendering.cell import cell
from benchnav.metrics.metric import Metric

QUESTION = (
    "How much does a map help? Each navigator ran in the same worlds twice: once with a complete"
    " map of walls and static obstacles (track known), and once without any map (track unknown)."
    " The price of ignorance is the difference, known − unknown, in each world, averaged."
)


def prices_of(records: Iterable[Record], navigator: str, metric: str) -> list[Record]:
    """Return the prices of one navigator by one metric, the mean over all scenarios first."""
    found = [
        r for r in records
        if (r.track, r.navigator, r.metric) == (PRICE, navigator, metric)
    ]  # fmt: skip
    return sorted(found, key=lambda r: (r.split, r.role, r.scenario != ALL, r.scenario))


def price_sentence(record: Record, metric: Metric) -> str:
    """Return a sentence about one price."""
    where = "Over all scenarios" if record.scenario == ALL else f"In {record.scenario}"
    role = f", {record.role}s" if record.role != "leader" else ""
    if record.note == NO_MAP:
        return f"{where}{role}: it uses no map, so a map changes nothing."
    if not record.episodes:
        return f"{where}{role}: no value, {record.note}."
    change = f"{metric.name} changes by {cell(record, interval=True, decided=False).text}"
    note = f" ({record.note})" if record.note else ""
    return f"{where}{role}: with the map, {change}{_judged(record)}{note}."


def _judged(record: Record) -> str:
    """Return whether the map helps, as far as the interval shows it."""
    if record.low != record.low:
        return ""
    if record.low <= 0.0 <= record.high:
        return "; that may be chance"
    if record.better is None:
        return ""
    return (
        "; the map helps"
        if (record.value > 0) == (record.better == "higher")
        else ("; the map harms")
    )


def price_sentences(
    records: Iterable[Record], navigator: str, metrics: Mapping[str, Metric], metric: str
) -> list[str]:
    """Return one sentence for each split and role: over all scenarios, or of the only one."""
    found = prices_of(records, navigator, metric)
    first: dict[tuple[str, str], Record] = {}
    for record in found:
        first.setdefault((record.split, record.role), record)
    return [price_sentence(record, metrics[metric]) for record in first.values()]
