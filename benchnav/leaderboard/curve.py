"""Success against time: the share of all agents that have succeeded by then."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from benchnav.arena.agents import Role
from benchnav.arrays import FloatArray
from benchnav.episode.episode import Episode
from benchnav.errors import UsageError
from benchnav.leaderboard import escape
from benchnav.leaderboard.cell import number
from benchnav.leaderboard.tidy import as_csv, as_json
from benchnav.metrics.success import success_by_horizon, success_time

FORMATS = ("markdown", "csv", "json")
COLUMNS = 10  # times in a table for people
POINTS = 100  # times in one for machines


@dataclass(frozen=True)
class Point:
    """A point of one curve: cumulative incidence of success, failures in the denominator."""

    navigator: str
    scenario: str
    track: str
    role: str
    time: float  # [s]
    share: float  # of the agents that had succeeded by then
    agents: int  # of all worlds together
    worlds: int
    split: str
    scenario_hash: str
    horizon: float  # [s]
    dt: float  # [s]
    rehearsal: int = 0  # rehearsals of each world that the navigator was granted


Key = tuple[str, str, str, str, str, float, float, int, str]


def success_curves(episodes: Iterable[Episode], points: int = POINTS) -> tuple[Point, ...]:
    """Curves of each navigator × scenario × track × role at ``points`` even times to the horizon.

    Episodes that differ in split, scenario hash, horizon, time step or rehearsals stand apart;
    one that occurs twice counts once. Background agents are left out.
    """
    times: dict[Key, dict[int, FloatArray]] = {}
    for episode in episodes:
        who, clock, agents = episode.identity, episode.world.clock, episode.world.agents
        succeeded = success_time(episode)
        for role in Role:
            members = agents.evaluated & (agents.role == role)
            if members.any():
                key = (
                    who.split, who.track, who.scenario, role.name.lower(), who.scenario_hash,
                    clock.horizon, clock.dt, episode.rehearsals, who.navigator,
                )  # fmt: skip
                times.setdefault(key, {})[who.seed] = succeeded[members]
    return tuple(point for key in sorted(times) for point in _curve(key, times[key], points))


def _curve(key: Key, worlds: dict[int, FloatArray], points: int) -> list[Point]:
    split, track, scenario, role, digest, horizon, dt, rehearsal, navigator = key
    every = np.concatenate(list(worlds.values()))
    at = np.linspace(0.0, horizon, points + 1)[1:]
    return [
        Point(
            navigator, scenario, track, role, float(time), float(share), len(every), len(worlds),
            split, digest, horizon, dt, rehearsal,
        )
        for time, share in zip(at, success_by_horizon(every, at), strict=True)
    ]  # fmt: skip


def render_curves(episodes: Iterable[Episode], format: str) -> str:
    """Curves as text that ends with a line break: Markdown tables, or tidy CSV or JSON.

    Raises UsageError for another format.
    """
    if format not in FORMATS:
        raise UsageError(f"A curve comes as {', '.join(FORMATS)}. Got {format!r} instead.")
    if format == "json":
        return as_json(success_curves(episodes))
    if format == "csv":
        return as_csv(Point, success_curves(episodes))
    points = success_curves(episodes, COLUMNS)
    tables = [_table(list(group)) for _, group in groupby(points, key=_place)]
    legend = "Share of all agents that had succeeded by then; failures stay in the denominator."
    return "\n".join([*tables, legend, ""])


def _place(p: Point) -> tuple[str, str, str, str, str, float, float, int]:
    return p.split, p.track, p.scenario, p.role, p.scenario_hash, p.horizon, p.dt, p.rehearsal


def _table(points: list[Point]) -> str:
    """The curves of one scenario, track and role, a row for each navigator."""
    first = points[0]
    title = f"{first.scenario}, track {first.track}, {first.role}s, {first.worlds} worlds"
    title += f", rehearsal: {first.rehearsal}" if first.rehearsal else ""
    shares: dict[str, list[str]] = {}
    for p in points:
        shares.setdefault(p.navigator, []).append(number(p.share, p.share))
    head = ["navigator", *(f"{p.time:g} s" for p in points[:COLUMNS])]
    body = [[escape.markdown(name), *row] for name, row in shares.items()]
    width = [max(3, *map(len, column)) for column in zip(head, *body, strict=True)]
    lines = [
        f"| {' | '.join(text.ljust(w) for text, w in zip(row, width, strict=True))} |"
        for row in (head, ["-" * w for w in width], *body)
    ]
    return "\n".join([f"### {escape.markdown(title)}", "", *lines, ""])
