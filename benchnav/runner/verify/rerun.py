"""Runs the navigators of a run again: only this finds commands that were replaced."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from benchnav.episode.episode import Episode
from benchnav.errors import BenchnavError
from benchnav.runner.cell import Cell
from benchnav.runner.entry import Entry, Meeting
from benchnav.runner.rehearsal import Performance, perform
from benchnav.runner.verify.finding import Report
from benchnav.runner.verify.part_check import Pair, PartCheck
from benchnav.runner.verify.stranger import is_by_module, is_program
from benchnav.store.manifest import ISOLATED
from benchnav.store.run_folder import RunFolder
from benchnav.world.build import sensing_of

_TOLD = ("act ", "reset ", "in rehearsal ", "the scenario's background ")  # raised or answered


def rerun(
    task: PartCheck, scored: Sequence[Pair], rehearsed: Sequence[Pair], packed: bool, report: Report
) -> None:
    """Report every episode that its navigator, run again, does not repeat to the last bit."""
    entry, why = installed(task.cell.entry, packed, [task.cell])
    if entry is None:
        report.notes[f"episode not run again: {why}"] += len(scored)
        return
    claimed = [pair for pair in scored if _asks_a_clock(pair.stored)]
    clock = bool(claimed) and not _is_reproducible(task, claimed[0])
    chosen = [pair for pair in scored if _repeatable(pair.stored, clock, report)]
    kept = {(_seed(p), p.stored.identity.rehearsal): p for p in (*chosen, *rehearsed)}
    worlds = [(_seed(pair), pair.again.world) for pair in chosen]
    for batch in perform(task.assignment, worlds):
        for performance in batch:
            _compare(performance, kept, report)
            report.counts["rerun"] += 1


def _seed(pair: Pair) -> int:
    return pair.stored.identity.seed


def _asks_a_clock(episode: Episode) -> bool:
    """Whether it claims so, and can be run again to see whether that is true."""
    return not episode.reproducible and _may_fail_again(episode)


def _may_fail_again(episode: Episode) -> bool:
    return not episode.failure or episode.failure.startswith(_TOLD)


def _is_reproducible(task: PartCheck, pair: Pair) -> bool:
    """Whether the navigators that are installed here ask no clock: an episode of theirs tells.

    What is stored is not asked: it may have been written to keep them from being run.
    """
    ((performance,),) = perform(task.assignment, [(_seed(pair), pair.again.world)])
    return performance.episode.reproducible


def _repeatable(episode: Episode, clock: bool, report: Report) -> bool:
    """``clock``: a clock decides what the navigators of the cell do, as they are installed."""
    if clock and not episode.reproducible:
        report.notes["episode not run again: a clock decides what its navigator does"] += 1
        return False
    if not _may_fail_again(episode):
        report.notes[f"episode not run again: it failed because {episode.failure}"] += 1
        return False
    return True


def _compare(
    performance: Performance, kept: Mapping[tuple[int, int], Pair], report: Report
) -> None:
    for new in (performance.episode, *performance.rehearsed.episodes):
        pair = kept.get((new.identity.seed, new.identity.rehearsal))
        if pair is None:
            continue  # that a rehearsal lacks is found without running anybody
        old = pair.stored
        for name in ("digest", "failure", "reproducible", "remarks"):
            left, right = getattr(old, name), getattr(new, name)
            if left != right:
                text = f"{name} is {_short(left)}, run again {_short(right)}"
                report.find("rerun", pair.where, text)


def installed(entry: Entry, packed: bool, cells: Sequence[Cell]) -> tuple[Entry | None, str]:
    """(the same navigator as it is installed here, ""), or (None, why there is none).

    Nothing that a stranger names by module is imported, and no program of theirs is started:
    only what is registered here. ``cells`` have the sensors that it is asked about.
    """
    if packed and is_program(entry.spec):
        return None, f"{entry.label} is a program, in somebody else's pack"
    if packed and is_by_module(entry.spec):
        return None, f"{entry.label} is named by its module, in somebody else's pack"
    sensings = tuple(dict.fromkeys(sensing_of(cell.scenario) for cell in cells))
    meeting = Meeting(sensings, entry.mode == ISOLATED)
    try:
        spec, where = {**entry.spec, "label": entry.label}, f"the navigator {entry.label!r}"
        found = meeting.entry(spec, where)
    except BenchnavError as error:
        return None, f"{entry.label} cannot be made here: {_short(str(error))}"
    if found.lacks:
        return None, f"{entry.label} cannot be made here: {found.lacks}"
    if found.hash != entry.hash:
        return None, f"{entry.label} is another one here ({found.source} instead of {entry.source})"
    if entry.source_hash and found.source_hash != entry.source_hash:
        return None, f"{entry.label} has another source here"
    return found, ""


def check_reasons(run: RunFolder, cells: Sequence[Cell], report: Report) -> None:
    """Report cells that are n/a and need not be, or the other way round."""
    entries: dict[str, tuple[Entry | None, str]] = {}
    said = {str(c["key"]): str(c.get("reason", "")) for c in run.manifest.cells}
    for cell in cells:
        label = cell.entry.label
        if label not in entries:
            entries[label] = installed(cell.entry, run.packed is not None, cells)
        entry, why = entries[label]
        stored = said.get(cell.key, "")
        if entry is None:
            if stored:
                report.notes[f"reason of a cell that is n/a: {why}"] += 1
            continue
        if entry.uses_map != cell.entry.uses_map:
            where = f"{cell.scenario.identity}, {label}"
            says = "uses" if entry.uses_map else "does not use"
            report.find("rerun", where, f"the navigator says that it {says} the map")
        if entry.training != cell.entry.training:
            where = f"{cell.scenario.identity}, {label}"
            what = f"training is {cell.entry.training}, but the navigator says {entry.training}"
            report.find("rerun", where, what)
        right = replace(cell, entry=entry).reason
        report.counts["rerun n/a"] += bool(stored)
        if right != stored:
            where = f"{cell.scenario.identity}, {cell.track}, {label}"
            report.find("rerun", where, f"n/a: {stored!r}, but the navigator says {right!r}")


def _short(value: Any) -> str:
    text = value if isinstance(value, str) else repr(value)
    text = re.sub(r"\s+", " ", text)
    return text if len(text) <= 120 else text[:117] + "..."
