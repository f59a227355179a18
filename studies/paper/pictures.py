"""The page's pictures, beside its text."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from benchnav_baselines.learned.recurrent_ppo.learning.log import full_rows
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon

from benchnav.arena.solid import Kind
from benchnav.arrays import FloatArray
from benchnav.episode.episode import Episode, Status

from . import cast, curves
from .encounters import REACH, Behaviour, Encounter
from .evidence import Evidence

COLOURS = {"red": "#d1495b", "green": "#2a9d8f", "blue": "#1f6feb", "yellow": "#d9a400"}
TEAMS = ("#1f6feb", "#d1495b", "#2a9d8f", "#8e5aa8")
STANDS, MOVES, INK = "#b3bec7", "#e07a3f", "#22303c"
TIMES = (0.0, 12.0, 20.0, 30.0)  # [s] of the snapshots


class Pictures:
    """Draws into a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def curves(self) -> None:
        """Figs. 9 and 10."""
        figure = Figure(figsize=(10, 3.6), layout="constrained")
        left, right = figure.subplots(1, 2)
        log = full_rows(curves.shipped_log())
        left.plot(curves.column(log, "decisions") / 1e6, curves.column(log, "reward"))
        left.set(title="recurrent-ppo while it learned", xlabel="million decisions",
                 ylabel="reward per attempt")  # fmt: skip
        for name, label, colour in (
            (curves.WITH, "with LSTM", TEAMS[0]), (curves.WITHOUT, "without", TEAMS[1]),
        ):  # fmt: skip
            for k, log in enumerate(map(full_rows, curves.logs(name))):
                x, y = curves.column(log, "decisions") / 1e6, curves.column(log, "reward")
                right.plot(x, y, color=colour, lw=1.2, label=label if k == 0 else None)
        right.set(title="three seeds each, among movers", xlabel="million decisions")
        right.legend()
        for axes in (left, right):
            axes.grid(alpha=0.3)
        self._save(figure, "paper-learning.png")

    def encounters(self, evidence: Evidence, found: dict[str, Behaviour]) -> None:
        """Fig. 8: one encounter, and all of them."""
        figure = Figure(figsize=(11, 4.2), layout="constrained")
        scene, speed, turn = figure.subplots(1, 3, width_ratios=[1.1, 1, 1])
        example = _telling(found[cast.PAPER].encounters)
        for episode in evidence.episodes((cast.DYNAMIC, "unknown", cast.PAPER)):
            if example is not None and episode.identity.seed == example.seed:
                _draw_encounter(scene, episode, example)
        dt = 0.2
        time = (np.arange(2 * REACH) - REACH) * dt
        for (navigator, b), colour in zip(found.items(), TEAMS, strict=False):
            missed = [e for e in b.encounters if not e.hit]
            _band(speed, time, [e.speed for e in missed], colour, navigator)
            _band(turn, time, [np.degrees(np.abs(e.turn)) for e in missed], colour, navigator)
        speed.set(title="speed", ylabel="m/s", xlabel="s from the closest approach", ylim=(0, 2.1))
        turn.set(title="change of heading since the alarm", ylabel="°",
                 xlabel="s from the closest approach", ylim=(0, None))  # fmt: skip
        speed.legend(fontsize="small", loc="lower left")
        for axes in (speed, turn):
            axes.axvline(0.0, color="0.6", ls=":", lw=1)
            axes.grid(alpha=0.3)
        self._save(figure, "paper-movers.png")

    def groups(self, evidence: Evidence) -> None:
        """Figs. 11, 12, 13, one row each, in the first world."""
        cells = [(cast.GROUPS, "known", navigator) for navigator in (cast.GUIDED, cast.BOTH)]
        guided, planned = (next(evidence.episodes(cell)) for cell in cells)
        seed = guided.identity.seed
        rehearsed = [e for e in evidence.rehearsals(cells[0]) if e.identity.seed == seed]
        figure = Figure(figsize=(13, 9.8), layout="constrained")
        rows = figure.subplots(3, len(TIMES), squeeze=False)
        for axes, episode in zip(rows[0], rehearsed, strict=False):
            _draw_rehearsal(axes, episode)
        for row, (episode, name) in zip(
            rows[1:], ((guided, "guided"), (planned, "navmesh + RVO")), strict=True
        ):
            for axes, time in zip(row, TIMES, strict=True):
                _draw_moment(axes, episode, time)
                axes.set_title(f"{name}, {time:.0f} s", fontsize=10)
        self._save(figure, "paper-groups.png")

    def _save(self, figure: Figure, name: str) -> None:
        self.folder.mkdir(parents=True, exist_ok=True)
        figure.savefig(self.folder / name, dpi=110, metadata={"Software": None})


def _telling(encounters: Sequence[Encounter]) -> Encounter | None:
    """The near miss with the greatest change of speed and heading, of those not at the start."""
    near = [e for e in encounters if not e.hit and e.gap < 0.6 and e.alarm > REACH]
    return max(near, key=lambda e: min(abs(e.sped), 1.0) + min(e.turned, 1.0), default=None)


def _band(
    axes: Axes, time: FloatArray, series: Iterable[FloatArray], colour: str, label: str
) -> None:
    values = np.array(list(series)).reshape(-1, len(time))
    known = np.isfinite(values).any(axis=0)
    if not known.any():
        return
    low, middle, high = np.nanpercentile(values[:, known], (25, 50, 75), axis=0)
    axes.plot(time[known], middle, color=colour, label=label)
    axes.fill_between(time[known], low, high, color=colour, alpha=0.15, lw=0)


def _draw_encounter(axes: Axes, episode: Episode, e: Encounter) -> None:
    _draw_world(axes, episode, movers=False)
    taken = int((episode.status[:-1, e.agent] == Status.ACTIVE).sum())
    first, last = max(0, e.closest - REACH), min(e.closest + REACH, taken)
    way = episode.position[first : last + 1, e.agent]
    path = episode.body_position[first : last + 1, e.body]
    body = episode.world.bodies[e.body].solid
    for k in range(0, len(way), 4):
        alpha = 0.25 + 0.6 * k / max(len(way) - 1, 1)
        radius = float(episode.world.agents.radius[e.agent])
        axes.add_patch(Circle(way[k], radius, color=TEAMS[0], alpha=alpha, lw=0))
        axes.add_patch(Polygon(body.moved(path[k]).loops[0], color=MOVES, alpha=alpha, lw=0))
    axes.plot(*way.T, color=TEAMS[0], lw=1.5)
    axes.plot(*path.T, color=MOVES, lw=1, ls=":")
    x, y = episode.position[e.closest, e.agent]
    axes.set(xlim=(x - 5, x + 5), ylim=(y - 5, y + 5))
    axes.set_title(f"recurrent-ppo, seed {e.seed}, every 0.8 s", fontsize=10)


def _draw_world(axes: Axes, episode: Episode, movers: bool = True, state: int = 0) -> None:
    world = episode.world
    x0, y0, x1, y1 = world.bounds
    for solid in world.solids:
        if solid.kind == Kind.STATIC:
            axes.add_patch(Polygon(solid.loops[0], color=STANDS, lw=0))
    for m, body in enumerate(world.bodies):
        if movers:
            shape = body.solid.moved(episode.body_position[state, m])
            axes.add_patch(Polygon(shape.loops[0], color=MOVES, lw=0))
    axes.set(xlim=(x0, x1), ylim=(y0, y1), aspect="equal", xticks=[], yticks=[])


def _draw_moment(axes: Axes, episode: Episode, time: float) -> None:
    """Draw the positions of all agents at one time; a leader is a ring."""
    state = min(round(time / episode.world.clock.dt), len(episode.position) - 1)
    _draw_world(axes, episode, state=state)
    agents = episode.world.agents
    here = episode.status[state] == Status.ACTIVE
    patches: list[Any] = []
    colours: list[str] = []
    for a in np.flatnonzero(here):
        colour = _colour(episode, int(a))
        patches.append(Circle(episode.position[state, a], float(agents.radius[a])))
        colours.append(colour)
    collection = PatchCollection(patches, facecolors=colours, edgecolors=INK, linewidths=0.2)
    axes.add_collection(collection)
    axes.set(xlim=(-19, 19), ylim=(-19, 19))


def _draw_rehearsal(axes: Axes, episode: Episode) -> None:
    """A leader's way; a cross where it ended before the goal."""
    _draw_world(axes, episode)
    agents = episode.world.agents
    for a in np.flatnonzero(agents.evaluated):
        taken = int((episode.status[:-1, a] == Status.ACTIVE).sum())
        way = episode.position[: taken + 1, a]
        colour = _colour(episode, int(a))
        axes.plot(*way.T, color=colour, lw=1.5)
        axes.add_patch(Circle(way[0], float(agents.radius[a]), color=colour))
        if not np.isfinite(episode.arrival[a]):
            axes.plot(*way[-1], marker="x", color=colour, ms=8, mew=2)
    axes.set(xlim=(-24, 24), ylim=(-24, 24))
    axes.set_title(f"rehearsal {episode.identity.rehearsal}", fontsize=10)


def _colour(episode: Episode, agent: int) -> str:
    team = episode.world.teams[int(episode.world.agents.team[agent])]
    return COLOURS.get(str(getattr(team, "name", team)), INK)
