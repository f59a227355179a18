"""The last lines of a run: stored episodes, failures, and remarks of navigators."""

from collections import Counter
from collections.abc import Iterator, Mapping

from benchnav.navigation.command_check import grouped, kind_of
from benchnav.runner.run import Summary
from benchnav.text.plural import counted

_SHOWN = 10  # lines of a kind


def conclusion(summary: Summary, seconds: float) -> str:
    """Return a summary of a run that took ``seconds``, as lines."""
    fresh = summary.stored - summary.found
    lines = [f"{counted(summary.stored, 'episode')} stored, {fresh} of them run in {seconds:.1f} s"]
    if fresh and seconds > 0:
        lines[0] += f" ({fresh / seconds:.3g} a second)"
    if summary.redraws:
        lines.append(
            f"drawn again, because they were not solvable: {counted(summary.redraws, 'world')}"
        )
    lines += [*_source(summary), *_not_applicable(summary)]
    for part in (_failures, _missing, _unled, _remarks):
        lines += _limited(list(part(summary)))
    return "\n".join(lines)


def tracebacks(summary: Summary) -> str:
    """Return one traceback for each kind of failure, for ``--debug``."""
    found = [f"{label}:\n{text}" for (label, _), text in sorted(summary.tracebacks.items())]
    return "\n\n".join(found) or "Nothing was raised."


def kept_for_now(summary: Summary) -> str:
    """Return a sentence about the episodes of older code that remain stored; "" if none do."""
    left = summary.older - summary.replaced.total()
    if not left:
        return ""
    return (
        f"{counted(left, 'episode')} of older code stay stored until all episodes of that"
        " navigator are run again."
    )


def _source(summary: Summary) -> Iterator[str]:
    for label, n in sorted(summary.replaced.items()):
        yield f"source changed: {counted(n, 'episode')} of {label!r} made by older code replaced"
    if left := kept_for_now(summary):
        yield left
    if summary.in_process:
        names = ", ".join(map(repr, summary.in_process))
        yield f"{names} ran in this process: no worker process can import what it registered"


def _limited(lines: list[str]) -> list[str]:
    more = len(lines) - _SHOWN
    return lines if more <= 1 else [*lines[:_SHOWN], f"… and {more} more like these"]


def _not_applicable(summary: Summary) -> Iterator[str]:
    reasons = Counter[tuple[str, str]]()
    for job, reason in summary.not_applicable:
        reasons[job.contestant.label, f"{reason} ({job.condition})"] += 1
    for (label, why), n in sorted(reasons.items()):
        yield f"n/a: {label} {why}, {counted(n, 'cell')}"


def _failures(summary: Summary) -> Iterator[str]:
    for label, reason, n in _grouped(summary.failures):
        yield f"failed: {label} in {counted(n, 'episode')}: {reason}"


def _missing(summary: Summary) -> Iterator[str]:
    for metric, reason, n in _grouped(summary.missing):
        yield f"the metric {metric} failed for {counted(n, 'value')}: {reason}"


def _unled(summary: Summary) -> Iterator[str]:
    for (label, scenario, team), n in summary.unled.most_common():
        yield (
            f"warning: {label}: the leader of {team!r} succeeded in no rehearsal in"
            f" {counted(n, 'world')} of {scenario}"
        )


def _remarks(summary: Summary) -> Iterator[str]:
    """Yield a line for each kind of remark, which counts the worlds of all scenarios."""
    worlds = Counter[tuple[str, str]]()
    for (label, _, text), n in summary.remarks.items():
        worlds[label, text] += n
    for label, text, n in _grouped(worlds):
        scenarios = {
            s
            for other, s, remark in summary.remarks
            if (other, kind_of(remark)) == (label, kind_of(text))
        }
        where = scenarios.pop() if len(scenarios) == 1 else f"{len(scenarios)} scenarios"
        yield f"remark: {label} in {counted(n, 'world')} of {where}: {text}"


def _grouped(found: Mapping[tuple[str, str], int]) -> list[tuple[str, str, int]]:
    """Return (label, reason, count), the largest count first; reasons of one kind are merged."""
    labels = sorted({label for label, _ in found})
    groups = [
        (label, reason, n)
        for label in labels
        for reason, n in grouped({why: k for (other, why), k in found.items() if other == label})
    ]
    return sorted(groups, key=lambda group: -group[2])
