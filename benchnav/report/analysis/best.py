"""Which navigators are best, in a sentence, and the commands that may separate the others."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from benchnav.leaderboard.record import Record
from benchnav.store.runs.run_folder import RunFolder
from benchnav.text.plural import counted

NAMED = 6  # navigators that a sentence names
MORE = 4  # times as many worlds give intervals of half the width


@dataclass(frozen=True)
class Best:
    """The best navigators of a ranked group."""

    text: str  # a sentence
    is_tied: bool  # more worlds may separate the best from others


def best_of(leaders: Sequence[Record]) -> Best | None:
    """Return which navigators are best; None if fewer than two are ranked.

    ``leaders`` are the records of one metric in one group, the best first.
    """
    ranked = [r for r in leaders if r.rank_low is not None]
    if len(ranked) < 2:
        return None
    metric, worlds = ranked[0].metric, counted(max(r.episodes for r in ranked), "world")
    first = [r for r in ranked if r.rank_low == 1]
    if len(first) == len(ranked):
        text = f"no navigator is separated from the others in {metric} by these {worlds}."
    elif len(first) > 1:
        text = f"{_listed(first)} share the first place in {metric}; these {worlds} do not"
        text += " separate them."
    elif first[0].rank_high == 1:
        text = f"{first[0].navigator} is significantly better in {metric} than each of the others."
        return Best(text, is_tied=False)
    else:
        text = f"{first[0].navigator} has the first place in {metric}; these {worlds} do not"
        text += " separate it from each of the others."
    return Best(text, is_tied=True)


def _listed(records: Sequence[Record]) -> str:
    names = [r.navigator for r in records]
    if len(names) > NAMED:
        return f"{', '.join(names[:NAMED])} and {counted(len(names) - NAMED, 'other')}"
    return f"{', '.join(names[:-1])} and {names[-1]}"


def more_seeds(folders: Sequence[RunFolder]) -> Iterator[str]:
    """Yield for each run the command that continues it with `MORE` times as many seeds."""
    for folder in folders:
        suite, out = folder.manifest.suite, shlex.quote(str(folder.shown))
        command = str(folder.manifest.provenance.get("command", ""))
        if not command.startswith("benchnav run "):
            command = f"benchnav run {shlex.quote(str(suite['name']))}"
        if " --out" not in command:
            command = f"{command} --out {out}"
        start, end = suite["seeds"]
        end = start + MORE * (end - start)
        yield f"{command} --seeds {f'{start}:{end}' if start else end}"
