"""Tables of results: a row for each navigator, a column for each metric."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from benchnav.leaderboard.record import Record
from benchnav.leaderboard.rendering.cell import column, heading, rank
from benchnav.report.report_data import ReportData
from benchnav.report.template import fill

if TYPE_CHECKING:
    from markupsafe import Markup


def metric_table(
    page: PurePosixPath, records: Sequence[Record], metrics: Sequence[str], data: ReportData
) -> Markup:
    """Return a table of the records of one scenario and view, in the order of the navigators.

    Cells have the text of the leaderboard; a navigator that was not run has the reason instead.
    ``page`` holds the table.
    """
    at = {(r.navigator, r.metric): r for r in records}
    held = [m for m in metrics if any(r.metric == m for r in records)]
    present = {r.navigator for r in records if r.metric in held}
    names = [name for name in data.navigators if name in present]
    columns = [
        column([at.get((name, m)) for name in names], decided=_is_decided(records, m)) for m in held
    ]
    rows = []
    for name, cells in zip(names, zip(*columns, strict=True), strict=True):
        found = [at.get((name, m)) for m in held]
        first = next(r for r in found if r is not None)
        rows.append({
            "navigator": name, "style": data.styles[name], "rehearsal": first.rehearsal,
            "rank": rank(found[0]).text, "cells": cells,
            "note": "" if first.episodes else first.note,
        })  # fmt: skip
    heads = [heading(next(r for r in records if r.metric == m)).text for m in held]
    return fill("metric_table.html", page=page, heads=heads, rows=rows)


def _is_decided(records: Sequence[Record], metric: str) -> bool:
    """Whether an entry is significantly worse than the best."""
    return any(r.metric == metric and (r.rank_low or 1) > 1 for r in records)
