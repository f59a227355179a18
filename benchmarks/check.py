"""Compare measured ratios with the kept ones: what ``make bench-check`` reports."""

from collections.abc import Iterator, Mapping, Sequence

from benchmarks.pair import Row

SLOWER = 0.9  # a row fails if its whole interval is below this share of the kept ratio


def failures(rows: Sequence[Row], kept: Mapping[str, float]) -> list[str]:
    """Return a sentence for each row that got slower or was not measured."""
    return [text for row in rows for text in _faults(row, kept.get(row.pair.name))]


def _faults(row: Row, kept: float | None) -> Iterator[str]:
    if row.note:
        yield f"{row.pair.name} was not measured: {row.note}"
    elif kept is not None and row.high < SLOWER * kept:
        yield (f"{row.pair.name}: the ratio is {row.text}, and {kept:.3g} is kept")


def report(row: Row, kept: float | None) -> str:
    """Return a line about one row and its kept ratio."""
    if row.note:
        return f"{row.pair.name}: not measured, {row.note}"
    before = "none is kept" if kept is None else f"kept {kept:.3g}"
    return f"{row.pair.name}: {row.text}, {before}"
