"""The page of failures: how many, the first of each, and how to watch the others."""

from __future__ import annotations

import shlex
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath

from benchnav.navigation.plugin.trainings import entry_of, labels_of_entry
from benchnav.report.failed_episodes import Cell, Failures
from benchnav.report.line_style import LineStyle
from benchnav.report.page import FAILURES, Page, replay_path
from benchnav.report.report_data import ReportData, family_of
from benchnav.report.template import fill
from benchnav.scenario.condition import perception_of


@dataclass(frozen=True)
class Row:
    """The failures of a navigator in a scenario and condition."""

    found: Failures
    family: str
    style: LineStyle
    share: float
    replay: PurePosixPath | None  # of the first failed episode
    command: str  # plays the first failed episode


def pages(
    data: ReportData, failures: Sequence[Failures], replays: Collection[Cell]
) -> Iterator[Page]:
    """Yield the page. ``replays`` are the cells whose first failed episode has a replay."""
    place = {name: k for k, name in enumerate(data.navigators)}
    order = {s.identity: k for k, s in enumerate(data.scenarios)}
    ordered = sorted(
        failures,
        key=lambda f: (
            order[f.scenario],
            data.conditions.index((f.track, f.perception)),
            place[entry_of(f.navigator)],
            f.navigator,
        ),
    )
    rows = [_row(data, f, replays) for f in ordered]
    body = fill(
        "failures.html",
        page=FAILURES, rows=rows, left_out=len(rows) - len(replays), run=_run(data, 0),
        is_exact=data.is_exact,
        filters=[
            ("scenario", "Scenario", list(dict.fromkeys(r.found.scenario for r in rows)), None),
            ("family", "Family", sorted({r.family for r in rows}), None),
            ("track", "Track", list(dict.fromkeys(r.found.track for r in rows)), None),
            ("perception", "Perception", sorted({r.found.perception for r in rows}), None),
            ("navigator", "Navigator", _named(data, rows), None),
        ],
    )  # fmt: skip
    yield Page(FAILURES, "Failures", body, FAILURES, has_tables=True)


def _named(data: ReportData, rows: Sequence[Row]) -> list[str]:
    """Return the navigators to choose from, with each training of an entry."""
    labels = sorted({row.found.navigator for row in rows})
    return [
        label for entry in data.navigators for label in labels_of_entry(entry, labels) or [entry]
    ]


def _row(data: ReportData, f: Failures, replays: Collection[Cell]) -> Row:
    has_replay = f.cell in replays
    words = [
        "benchnav", "replay", _run(data, _owner(data, f)), "--navigator", f.navigator,
        "--scenario", f.scenario, "--track", f.track,
        *([] if data.is_exact else ["--perception", f.perception]), "--seed", str(f.seed),
    ]  # fmt: skip
    return Row(
        f, family_of(f.scenario), data.styles[f.navigator], f.failed / f.episodes,
        replay_path(f.navigator, f.scenario, f.track, f.seed, f.perception) if has_replay else None,
        shlex.join(words),
    )  # fmt: skip


def _owner(data: ReportData, f: Failures) -> int:
    """Return the number of the run that holds the cell."""
    for number, folder in enumerate(data.folders):
        for cell in folder.manifest.cells:
            tracks = (*cell.get("also", ()), cell["track"])
            cells = [
                (cell["navigator"], cell["scenario"], track, perception_of(cell))
                for track in tracks
            ]
            if f.cell in cells and not cell["reason"]:
                return number
    return 0


def _run(data: ReportData, number: int) -> str:
    return str(data.folders[number].shown)
