"""The records that a page needs, also of metrics that are not on the leaderboard."""

from collections.abc import Iterable

from benchnav.leaderboard.record import Record
from benchnav.report.report_data import ReportData


def records_with(data: ReportData, metrics: Iterable[str]) -> list[Record]:
    """Return the records of the leaderboard, and those of the measured ``metrics`` besides."""
    held = set(data.values.names)
    missing = [name for name in metrics if name in held and name not in data.metrics]
    return [*data.board.records, *(data.values.board(missing).records if missing else ())]
