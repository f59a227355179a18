"""The world of a table of trajectories: bodies, goals, walls and rules."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from benchnav.arena.agents import Agents, Dynamics, Role
from benchnav.arena.sensing import Sensing
from benchnav.arena.world import Afterwards, Charge, Clock, ContactRule, Rules, World
from benchnav.arrays import ByteArray, Extent, FloatArray, IntArray
from benchnav.errors import TrajectoryError
from benchnav.scoring.bodies import Columns, shape_of_agents, shape_of_table
from benchnav.scoring.table_file import Table
from benchnav.scoring.tracks import Tracks

GOAL_TOLERANCE = 0.3  # [m] default
_SAME = 0.05  # [m] largest distance of a first position from a start of the scenario


@dataclass(frozen=True, kw_only=True)
class Options:
    """Values for all ids; a column of the table is used before them."""

    radius: float | None = None  # [m]
    preferred_speed: float | None = None  # [m/s]
    goals: Literal["columns", "last"] = "columns"  # last: each id's goal is its last position
    goal_tolerance: float | None = None  # [m]; None: of the scenario, else the default
    area: Extent | None = None  # [m] for densities and flow


@dataclass(frozen=True, eq=False)
class Setting:
    """The world of some tracks, and what is known of it."""

    world: World
    known: frozenset[str]  # of radius, goals, preferred_speed, walls, movers, horizon, area, …
    remarks: tuple[str, ...] = ()


def setting_of(table: Table, tracks: Tracks, options: Options, drawn: World | None) -> Setting:
    """Return the setting: a world of a scenario, or an open one without walls.

    Args:
        table: holds columns of radius, goal, preferred speed and team.
        tracks: of one episode.
        options: values for all ids.
        drawn: a world of a scenario, whose agents are used if they start where the ids do.
    """
    match = None if drawn is None else _same_agents(tracks, drawn)
    theirs = _Theirs(drawn, match) if drawn is not None and match is not None else None
    known: set[str] = set()
    agents, names = _agents(table, tracks, options, theirs, known)
    tolerance = options.goal_tolerance
    if options.goals == "last" and tolerance is None:
        tolerance = 0.0
    if drawn is None:
        world = _open(tracks, agents, names, GOAL_TOLERANCE if tolerance is None else tolerance)
        known.add("obstacles")
        remarks = ["No walls are known: only contacts and distances between ids count."]
    else:
        placed = not drawn.bodies or (theirs is not None and not drawn.relocates)
        world = _of_scenario(drawn, tracks, agents, names, tolerance, placed)
        known |= {"walls", "horizon"} | ({"movers", "obstacles"} if placed else set())
        if theirs is not None and placed and world.has_people:
            known.add("people")
        remarks = _remarks(drawn, theirs, placed)
    if options.area is not None:
        world = replace(world, measurement_area=options.area)
    if world.measurement_area is not None:
        known.add("area")
    return Setting(world, frozenset(known), tuple(remarks))


@dataclass(frozen=True, eq=False)
class _Theirs:
    """The agents of a scenario's world, and which of them each id is."""

    world: World
    match: IntArray  # (A,)

    @property
    def agents(self) -> Agents:
        return self.world.agents


def _remarks(drawn: World, theirs: _Theirs | None, placed: bool) -> list[str]:
    found = []
    if theirs is None:
        found.append(
            "The ids do not start where the scenario's agents do: its walls, rules and horizon"
            " are used, and nothing of its agents."
        )
    if not placed:
        found.append(
            "The places of the scenario's moving obstacles are unknown, and metrics of contacts"
            " and distances are n/a: "
            + (
                "static obstacles are relocated when agents leave their new places."
                if drawn.relocates
                else "the ids would have to start where its agents do."
            )
        )
    return found


def _agents(
    table: Table, tracks: Tracks, options: Options, theirs: _Theirs | None, known: set[str]
) -> tuple[Agents, tuple[str, ...]]:
    """Return the agents and the names of teams; add what is known of them to ``known``."""
    count = len(tracks)
    each = np.arange(count)
    body = _bodies(table, tracks, options, theirs, known)
    speed = _values(table, tracks, "preferred_speed", options.preferred_speed, theirs, known)
    heading = np.zeros(count) if tracks.heading is None else tracks.heading[each, tracks.first]
    team, names = _teams(table, tracks.rows)
    role: ByteArray = np.full(count, int(Role.LEADER), np.int8)
    driver: IntArray = np.zeros(count, np.int64)
    if "team" in table.frame:
        known.add("teams")
    if theirs is not None:
        known |= {"teams", "roles"}
        names, own = theirs.world.teams, theirs.agents
        team, driver = own.team[theirs.match], own.driver[theirs.match]
        role = np.asarray(own.role[theirs.match], np.int8)
    agents = Agents(
        start=tracks.place[each, tracks.first], heading=heading,
        goal=_goals(table, tracks, options, theirs, known),
        max_speed=np.full(count, np.inf), preferred_speed=speed,
        max_turn_rate=np.full(count, np.inf),
        dynamics=np.full(count, int(Dynamics.HOLONOMIC), np.int8), role=role, team=team,
        driver=driver, **body,
    )  # fmt: skip
    return agents, names


def _bodies(
    table: Table, tracks: Tracks, options: Options, theirs: _Theirs | None, known: set[str]
) -> Columns:
    """Return radius and shape; add what a measurement of these bodies can rely on to ``known``."""
    body = shape_of_table(table, tracks.rows)
    if body is None:
        radius = _values(table, tracks, "radius", options.radius, theirs, known)
        body = {"radius": radius}
        if theirs is not None:
            body |= shape_of_agents(theirs.agents, theirs.match, radius)
    else:
        known.add("radius")
    discs = not body.get("rounding", np.zeros(1)).any()
    known |= {"discs"} if discs else set()
    known |= {"heading"} if discs or tracks.heading is not None else set()
    return body


def _values(
    table: Table, tracks: Tracks, name: Literal["radius", "preferred_speed"], option: float | None,
    theirs: _Theirs | None, known: set[str],
) -> FloatArray:  # fmt: skip
    """Return values (A,) > 0 of the column, the option or the scenario; 0 if unknown."""
    column = table.column(name)
    if column is not None:
        found: FloatArray = column[tracks.rows]
    elif option is not None:
        found = np.full(len(tracks), option)
    elif theirs is not None:
        found = getattr(theirs.agents, name)[theirs.match]
    else:
        return np.zeros(len(tracks))
    if not (found > 0.0).all():
        row = int(tracks.rows[np.argmax(~(found > 0.0))])
        raise TrajectoryError(
            f"{table.place(row)}: {name} must be > 0; got {found.min():g}. Correct it."
        )
    known.add(name)
    return found


def _goals(
    table: Table, tracks: Tracks, options: Options, theirs: _Theirs | None, known: set[str]
) -> FloatArray:
    """Return goals (A, 2) [m]; the last positions if unknown."""
    x, y = table.column("goal_x"), table.column("goal_y")
    known.add("goals")
    if options.goals == "columns":
        if x is not None and y is not None:
            return np.stack([x[tracks.rows], y[tracks.rows]], axis=1)
        if theirs is not None:
            goals: FloatArray = theirs.agents.goal[theirs.match]
            return goals
        known.discard("goals")
    return tracks.place[:, -1]


def _same_agents(tracks: Tracks, drawn: World) -> IntArray | None:
    """Return the agent (A,) that starts where each id does; None if the starts differ."""
    starts = drawn.agents.start
    if len(starts) != len(tracks) or not tracks.together:
        return None
    from scipy.spatial import cKDTree

    distance, nearest = map(np.asarray, cKDTree(starts).query(tracks.place[:, 0]))
    if distance.max() > _SAME or len(np.unique(nearest)) < len(starts):
        return None
    return nearest.astype(np.int64)


def _teams(table: Table, rows: IntArray) -> tuple[IntArray, tuple[str, ...]]:
    if "team" not in table.frame:
        return np.zeros(len(rows), np.int64), ("all",)
    names, team = np.unique(table.frame["team"].to_numpy()[rows].astype(str), return_inverse=True)
    return team.astype(np.int64), tuple(map(str, names))


def _open(tracks: Tracks, agents: Agents, names: tuple[str, ...], tolerance: float) -> World:
    points = np.concatenate([tracks.place.reshape(-1, 2), agents.goal])
    low, high = points.min(axis=0) - 1.0, points.max(axis=0) + 1.0
    return World(
        bounds=(float(low[0]), float(low[1]), float(high[0]), float(high[1])), solids=(),
        bodies=(), agents=agents, teams=names, sees=np.ones((len(names), len(names)), np.bool_),
        clock=Clock(tracks.dt, 1, tracks.place.shape[1] - 1),
        rules=Rules(
            tolerance, ContactRule.SLIDE, Afterwards.VANISH, Afterwards.VANISH, Charge.HITTER
        ),
        sensing=Sensing(None, None, None),
    )  # fmt: skip


def _of_scenario(
    drawn: World, tracks: Tracks, agents: Agents, names: tuple[str, ...], tolerance: float | None,
    placed: bool,
) -> World:  # fmt: skip
    steps = max(1, round(drawn.clock.horizon / tracks.dt))
    rules = drawn.rules if tolerance is None else replace(drawn.rules, goal_tolerance=tolerance)
    return replace(
        drawn, agents=agents, teams=names, bodies=drawn.bodies if placed else (), rules=rules,
        sees=np.ones((len(names), len(names)), np.bool_),
        clock=replace(drawn.clock, dt=tracks.dt, substeps=1, steps=steps),
    )  # fmt: skip
