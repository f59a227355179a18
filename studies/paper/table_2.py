"""Table 2, every cell a measurement."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from benchnav.episode.episode import Status

from . import cast
from .evidence import Evidence
from .markdown import table

HEAD = (
    "method", "navigator", "known → unknown", "static obstacles moved: old → new → no map",
    "hits of movers", "reaches the goal: trap/u, maze/grid", "distinct commands; turning",
)  # fmt: skip


@dataclass(frozen=True)
class Row:
    """One method of the table."""

    method: str
    navigator: str
    track: str  # that it is meant for


ROWS = (
    Row("global planning alone", cast.PLANNER, "known"),
    Row("… mapping online", cast.MAPPER, "unknown"),
    Row("… on an empty map", cast.BLIND, "unknown"),
    Row("local avoidance alone", cast.LOCAL, "unknown"),
    Row("planning with avoidance", cast.BOTH, "known"),
    Row("… mapping online", cast.MAPPING_BOTH, "unknown"),
    Row("tabular Q-learning", cast.TABULAR, "unknown"),
    Row("… over grid cells", cast.GRID, "known"),
    Row("the paper's method", cast.PAPER, "unknown"),
    Row("seeing all round, looking ahead", cast.PLUS, "unknown"),
    Row("… with a map made online and ORCA", cast.HYBRID, "unknown"),
)


def section(evidence: Evidence) -> Iterator[str]:
    """Lines of the page."""
    yield "## Table 2, measured"
    yield ""
    yield (
        "Success per agent in % unless said, in `leaders/static` (known → unknown) and"
        " `leaders/moved`; collisions with movers per 100 agents in `leaders/dynamic`; arrival in %"
        " in `trap/u` and `maze/grid`; different commands among all decisions in `leaders/static`"
        " (`of`"
        " how many) and turning in rad/m there. The last three in the track that the method is"
        " meant for. n/a: it cannot be run so; *in each*: the same in every world, whatever the"
        " map."
    )
    yield ""
    yield from table(HEAD, [_cells(evidence, row) for row in ROWS])


def _cells(evidence: Evidence, row: Row) -> list[str]:
    navigator, track = row.navigator, row.track
    ends = [
        evidence.value("arrival", (scenario, track, navigator)).text(100)
        for scenario in (cast.TRAP, cast.MAZE)
    ]
    distinct, decisions = commands(evidence, (cast.STATIC, track, navigator))
    turning = evidence.value("turning", (cast.STATIC, track, navigator)).text(1, 2)
    return [
        row.method,
        f"`{navigator}`",
        _success(evidence, cast.STATIC, ("known", "unknown"), navigator),
        _success(evidence, cast.MOVED, ("stale", "known", "unknown"), navigator),
        evidence.value("collisions_dynamic", (cast.DYNAMIC, track, navigator)).text(100),
        ", ".join(ends),
        f"{distinct:,} of {decisions:,}; {turning}",
    ]


def _success(evidence: Evidence, scenario: str, tracks: tuple[str, ...], navigator: str) -> str:
    """Of every track; once where no map makes a difference."""
    cells = [(scenario, track, navigator) for track in tracks]
    values = [evidence.value("success", cell) for cell in cells]
    if evidence.alike("success", cells):
        return f"{values[0].text(100)} in each"
    return " → ".join("n/a" if math.isnan(v.mean) else v.text(100) for v in values)


def commands(evidence: Evidence, cell: tuple[str, str, str]) -> tuple[int, int]:
    """Return the number of different commands, and the number of decisions."""
    given = [
        episode.requested[episode.status[:-1] == Status.ACTIVE]
        for episode in evidence.episodes(cell)
    ]
    every = np.concatenate(given) if given else np.zeros((0, 2))
    return len(np.unique(every, axis=0)), len(every)
