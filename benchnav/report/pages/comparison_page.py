"""The pages about each comparison."""

from collections.abc import Iterator

from benchnav.report.page import Page
from benchnav.report.report_data import ReportData


def pages(data: ReportData) -> Iterator[Page]:
    """Yield the pages."""
    yield from ()
