"""Worlds and episodes as figures for papers: top views with trails, or snapshots in a row."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from benchnav.arena.body import absent
from benchnav.arena.outline import outline, placed
from benchnav.arena.solid import Kind, Solid, is_outside
from benchnav.arena.world import World
from benchnav.arrays import Extent, FloatArray
from benchnav.drawing.palette import FILL, INK, agent_color
from benchnav.episode.episode import Episode, Status
from benchnav.errors import UsageError
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.metrics.quantities.trajectory import entered_at, positions_at, present_at
from benchnav.viewer.picture import blank

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WALL, STATIC, MOVER = (FILL[kind] for kind in (Kind.WALL, Kind.STATIC, Kind.DYNAMIC))
MARK = 5.0  # [s] between the marks on a trail
MOST_SNAPSHOTS = 8
_RIM = 0.012  # of the width of an arena: how thick the wall along its bounds is drawn
_WIDTH = 3.4  # [inch] of one arena in a row
_SINGLE = 5.2  # [inch] of an arena alone
_HEAD, _FOOT = 0.3, 0.25  # [inch] for the title, and for the scale bar
_LENGTHS = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0)  # [m] of scale bars


def world_figure(world: World) -> Figure:
    """Return a world at t = 0: agents at their starts, rings at the goals of all."""
    figure = blank(_SINGLE, _SINGLE / aspect(world) + _FOOT)
    axes = figure.subplots()
    frame = draw_arena(axes, world, _first_places(world))
    draw_agents(axes, world, world.agents.start, world.agents.heading, world.agents.enters <= 0.0)
    draw_goals(axes, world)
    _tidy(axes, frame)
    _draw_scale(axes, world)
    return figure


def episode_figure(episodes: Sequence[Episode], times: Sequence[float] = ()) -> Figure:
    """Return episodes side by side, with trails; or snapshots at ``times`` [s], a row each.

    A trail grows darker with time and has a mark every 5 s. A cross is where an agent was when its
    attempt ended without arrival. The first picture of each world has a scale bar.

    Raises UsageError for a time outside an episode.
    """
    _check_times(episodes, times)
    columns = len(times) or len(episodes)
    rows = len(episodes) if times else 1
    wide = _SINGLE if columns == 1 else _WIDTH
    ratio = min(aspect(episode.world) for episode in episodes)
    figure = blank(wide * columns, (wide / ratio + _HEAD + _FOOT) * rows)
    scaled = set()
    for axes, (episode, time, title) in zip(
        figure.subplots(rows, columns, squeeze=False).ravel(), _panels(episodes, times), strict=True
    ):
        draw_episode(axes, episode, time)
        axes.set_title(title, fontsize=9, color=INK)
        if episode.world.bounds not in scaled:
            _draw_scale(axes, episode.world)
            scaled.add(episode.world.bounds)
    return figure


def draw_episode(axes: Axes, episode: Episode, time: float | None = None) -> None:
    """Draw the trails until ``time`` [s] and everything as it is then; None: until the end.

    At the end the agents are drawn at their starts, so that the trails stay visible.
    """
    world, end = episode.world, float(episode.times[-1])
    state = len(episode.position) - 1 if time is None else round(min(time, end) / world.clock.dt)
    at_start = time is None
    bodies = episode.body_position[0 if at_start else state]
    frame = draw_arena(axes, world, bodies)
    for way in episode.body_position.transpose(1, 0, 2):
        axes.plot(
            *way[~absent(way)].T, color=MOVER, linewidth=0.7, linestyle=(0, (1, 2)), zorder=1.5
        )
    draw_goals(axes, world)
    draw_trails(axes, episode, end if time is None else time)
    if at_start:
        draw_agents(axes, world, world.agents.start, world.agents.heading)
    else:
        here = present_at(analyse(episode).trajectories, np.array([time]))[:, 0]
        draw_agents(axes, world, episode.position[state], episode.heading[state], here)
    _tidy(axes, frame)


def draw_arena(axes: Axes, world: World, bodies: FloatArray) -> Extent:
    """Draw walls and obstacles, with moving ones at ``bodies`` (M, 2) [m]; return the frame."""
    x0, y0, x1, y1 = world.bounds
    rim = _RIM * max(x1 - x0, y1 - y0)
    frame = (x0 - rim, y0 - rim, x1 + rim, y1 + rim)
    for solid in world.solids:
        color = WALL if solid.kind == Kind.WALL else STATIC
        axes.add_patch(_patch(solid, frame, color=color, linewidth=0.6))
    for body, position in zip(world.bodies, bodies, strict=True):
        if absent(position):
            continue
        color = STATIC if body.solid.kind == Kind.STATIC else MOVER
        axes.add_patch(_patch(body.solid.moved(position), frame, color=color, linewidth=0))
    return frame


def draw_agents(
    axes: Axes, world: World, position: FloatArray, heading: FloatArray, here: Any = None
) -> None:
    """Draw the bodies of agents at ``position`` (A, 2) [m]; only those in ``here`` (A,)."""
    from matplotlib.patches import Circle, Polygon

    for a, (x, y) in enumerate(position):
        if here is not None and not here[a]:
            continue
        length, shape = 1.6 * float(world.agents.radius[a]), outline(world.agents, a)
        style: dict[str, Any] = {"color": agent_color(world, a), "linewidth": 0, "zorder": 4}
        if shape is None:
            axes.add_patch(Circle((x, y), float(world.agents.radius[a]), **style))
        else:
            axes.add_patch(Polygon(placed(shape, position[a], float(heading[a])), **style))
            length = 1.2 * float(world.agents.half_length[a])
        tip = length * np.array([np.cos(heading[a]), np.sin(heading[a])])
        axes.plot([x, x + tip[0]], [y, y + tip[1]], color=INK, linewidth=0.7, zorder=5)


def draw_goals(axes: Axes, world: World) -> None:
    """Draw a ring at the goal of every agent."""
    from matplotlib.patches import Circle

    for a, (x, y) in enumerate(world.agents.goal):
        ring = Circle(
            (x, y), float(world.agents.radius[a]), fill=False, edgecolor=agent_color(world, a),
            linewidth=1.0, zorder=3,
        )  # fmt: skip
        axes.add_patch(ring)


def draw_trails(axes: Axes, episode: Episode, until: float) -> None:
    """Draw the way of every agent until a time [s], with a mark every 5 s."""
    from matplotlib.collections import LineCollection
    from matplotlib.colors import to_rgba

    trajectories, dt = analyse(episode).trajectories, episode.world.clock.dt
    arrived, begin = episode.status[-1] == int(Status.ARRIVED), trajectories.begin
    for a in np.flatnonzero(entered_at(trajectories, np.array([until]))[:, 0]):
        last = min(int(trajectories.last[a]), round(until / dt))
        points = trajectories.position[a, round(begin[a] / dt) : last + 1]
        pieces = list(np.stack([points[:-1], points[1:]], axis=1))
        color = agent_color(episode.world, int(a))
        shades = [to_rgba(color, alpha) for alpha in np.linspace(0.3, 1.0, max(len(pieces), 1))]
        axes.add_collection(LineCollection(pieces, colors=shades, linewidths=1.3, zorder=3.5))
        times = np.arange(MARK, min(trajectories.end[a], until) + 1e-9, MARK)
        marks = positions_at(trajectories, times[times >= begin[a]])[a]
        axes.plot(*marks.T, ".", color=color, markersize=4, zorder=3.6)
        if not arrived[a] and until >= trajectories.end[a]:
            axes.plot(*points[-1], "x", color=color, markersize=7, markeredgewidth=2, zorder=6)


def _panels(
    episodes: Sequence[Episode], times: Sequence[float]
) -> Iterator[tuple[Episode, float | None, str]]:
    for episode in episodes:
        name = episode.identity.navigator
        if not times:
            arrivals = episode.arrival[episode.world.agents.evaluated]
            arrived = int(np.isfinite(arrivals).sum())
            yield episode, None, f"{name}: {arrived} of {len(arrivals)} arrived"
        for n, time in enumerate(times):
            yield episode, time, f"{name}, {time:g} s" if n == 0 else f"{time:g} s"


def _check_times(episodes: Sequence[Episode], times: Sequence[float]) -> None:
    longest = max(float(episode.times[-1]) for episode in episodes)
    wrong = [time for time in times if not 0.0 <= time <= longest]
    if wrong:
        raise UsageError(
            f"A time must be from 0 to {longest:g} s, when the last episode ends."
            f" Got {wrong[0]:g} s."
        )
    if len(times) > MOST_SNAPSHOTS:
        raise UsageError(f"A row shows {MOST_SNAPSHOTS} times at most. Got {len(times)}.")


def _first_places(world: World) -> FloatArray:
    from benchnav.world.simulation import Simulation

    places: FloatArray = Simulation([world]).body_position[0][: len(world.bodies)]
    return places


def _draw_scale(axes: Axes, world: World) -> None:
    """Draw a bar with its length below the lower left corner of an arena."""
    x0, _, x1, _ = world.bounds
    length = max([n for n in _LENGTHS if n <= 0.3 * (x1 - x0)], default=_LENGTHS[0])
    place = axes.get_xaxis_transform()  # x in metres, y from 0 to 1
    axes.plot(
        [x0, x0 + length], [-0.02, -0.02], color=INK, linewidth=2.0, solid_capstyle="butt",
        transform=place, clip_on=False,
    )  # fmt: skip
    axes.text(
        x0 + length + 0.01 * (x1 - x0), -0.02, f"{length:g} m", transform=place, fontsize=7,
        color=INK, verticalalignment="center",
    )  # fmt: skip


def _tidy(axes: Axes, frame: Extent) -> None:
    axes.set(xlim=frame[::2], ylim=frame[1::2], aspect="equal", xticks=[], yticks=[])
    for spine in axes.spines.values():
        spine.set_visible(False)


def _patch(solid: Solid, frame: Extent, **style: Any) -> Any:
    """Return the area of a solid; the outside of a walled arena ends at the frame."""
    from matplotlib.patches import Circle, PathPatch
    from matplotlib.path import Path

    if solid.is_disc:
        return Circle(solid.center, solid.radius, **style)
    loops = list(solid.loops)
    if is_outside(solid):
        x0, y0, x1, y1 = frame
        loops.append(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]))
    closed = [Path(np.vstack([loop, loop[:1]]), closed=True) for loop in loops]
    return PathPatch(Path.make_compound_path(*closed), **style)


def aspect(world: World) -> float:
    """Return the width of the bounds over their height."""
    x0, y0, x1, y1 = world.bounds
    return (x1 - x0) / (y1 - y0)
