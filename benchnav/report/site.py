"""Write a report: a folder of pages."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import chain
from pathlib import Path

from benchnav.leaderboard.from_runs import StoredValues
from benchnav.report.failed_episodes import choose_replays, find_failures
from benchnav.report.page import (
    ABOUT,
    ASSETS,
    COMPARISON,
    FAILURES,
    LEADERBOARD,
    NAVIGATORS,
    SCENARIOS,
    Page,
    Site,
    render,
)
from benchnav.report.pages import (
    about_page,
    comparison_page,
    failures_page,
    leaderboard_page,
    navigator_page,
    scenario_page,
)
from benchnav.report.replays import ReplayPlan
from benchnav.report.report_data import ReportData, read_runs
from benchnav.report.report_folder import replaced_folder, require_replaceable
from benchnav.report.shared_files import require_libraries, write_assets
from benchnav.runner.execute.progress import Progress, progress
from benchnav.store.runs.manifest import versions
from benchnav.store.runs.run_folder import RunFolder

REPLAYS = 100  # at most, unless another number is given
ENTRIES = (
    ("Leaderboard", LEADERBOARD), ("Scenarios", SCENARIOS), ("Navigators", NAVIGATORS),
    ("Compare", COMPARISON), ("Failures", FAILURES), ("About", ABOUT),
)  # fmt: skip


@dataclass(frozen=True)
class Written:
    """The size of a written report."""

    index: Path  # the first page
    pages: int  # without replays
    replays: int
    bytes: int  # of pages and replays, without the shared assets


def write_report(
    folders: Sequence[RunFolder],
    values: Callable[[], StoredValues],
    out: Path,
    *,
    metrics: Sequence[str] | None = None,
    replays: int = REPLAYS,
    quiet: bool = True,
) -> Written:
    """Write the report of some runs into the folder ``out``; an earlier report is replaced.

    Args:
        folders: the runs.
        values: reads their measured values.
        out: the folder.
        metrics: names of metrics on the leaderboard, or "all"; None: the usual ones and some more.
        replays: the largest number of failed episodes that get a page which plays them.
        quiet: show no progress.

    Raises:
        UsageError: the folder holds something else, or is part of a run.
        MissingExtraError: a library is not installed.
        StoreError: a file cannot be written.
        CorruptPartError: a part of a run is damaged.
    """
    require_libraries()
    require_replaceable(out)
    measured = values()
    failures = find_failures(measured.results)
    with replaced_folder(out) as folder:
        write_assets(folder / ASSETS)
        chosen = choose_replays(failures, replays)
        plan = ReplayPlan({f.cell: f.seed for f in chosen}, folder)
        data = read_runs(folders, measured, metrics, plan, progress(quiet))
        pages = chain(
            leaderboard_page.pages(data), scenario_page.pages(data), navigator_page.pages(data),
            comparison_page.pages(data), failures_page.pages(data, failures, data.replays),
            about_page.pages(data, datetime.now(UTC)),
        )  # fmt: skip
        total = len(ENTRIES) + len(data.scenarios) + len(data.navigators)
        count = _write_pages(pages, _site(data), folder, total, progress(quiet, "page"))
    size = sum(p.stat().st_size for p in _files(out) if ASSETS.name not in p.relative_to(out).parts)
    return Written(out / LEADERBOARD, count, len(data.replays), size)


def _write_pages(
    pages: Iterator[Page], site: Site, folder: Path, total: int, display: Progress
) -> int:
    """Write the pages, ``total`` or so, and return their number."""
    count = 0
    display.begin(total, 0)
    try:
        for page in pages:
            target = folder / page.path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(render(page, site), encoding="utf-8")
            display.advance(1)
            count += 1
    finally:
        display.end()
    return count


def _site(data: ReportData) -> Site:
    suites = dict.fromkeys(
        f"{folder.manifest.suite['name']}@{folder.manifest.suite['version']}"
        for folder in data.folders
    )
    title = f"benchnav: {', '.join(suites)}"
    return Site(title, ENTRIES, f"Made by benchnav {versions().get('benchnav', '')}.")


def _files(folder: Path) -> Iterator[Path]:
    return (path for path in folder.rglob("*") if path.is_file())
