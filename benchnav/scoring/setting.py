"""What a table of trajectories does not hold: bodies, goals, walls and rules."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from benchnav.arena.agents import Agents, Dynamics, Role
from benchnav.arena.sensing import Sensing
from benchnav.arena.world import Afterwards, Charge, Clock, ContactRule, Rules, World
from benchnav.arrays import Extent, FloatArray, IntArray
from benchnav.errors import TrajectoryError
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
    rows = tracks.rows
    known: set[str] = set()
    remarks: list[str] = []
    match = None if drawn is None else _same_agents(tracks, drawn)
    own = None if drawn is None or match is None else drawn.agents
    start = tracks.place[np.arange(len(tracks)), tracks.first]
    final = tracks.place[:, -1]

    def value(name: str, option: float | None, theirs: FloatArray | None) -> FloatArray:
        column = table.column(name)
        if column is not None:
            found = column[rows]
        elif option is not None:
            found = np.full(len(tracks), option)
        elif theirs is not None and match is not None:
            found = theirs[match]
        else:
            return np.zeros(len(tracks))
        if not (found > 0.0).all():
            row = int(rows[np.argmax(~(found > 0.0))])
            raise TrajectoryError(
                f"{table.place(row)}: {name} must be > 0; got {found.min():g}. Correct it."
            )
        known.add(name)
        return found

    radius = value("radius", options.radius, own.radius if own else None)
    speed = value("preferred_speed", options.preferred_speed, own.preferred_speed if own else None)
    goal, tolerance = final, options.goal_tolerance
    x, y = table.column("goal_x"), table.column("goal_y")
    if options.goals == "last":
        known.add("goals")
        tolerance = 0.0 if tolerance is None else tolerance
    elif x is not None and y is not None:
        goal = np.stack([x[rows], y[rows]], axis=1)
        known.add("goals")
    elif own is not None and match is not None:
        goal = own.goal[match]
        known.add("goals")
    team, names = _teams(table, rows)
    if "team" in table.frame:
        known.add("teams")
    role = np.full(len(tracks), int(Role.LEADER), np.int8)
    driver = np.zeros(len(tracks), np.int64)
    if own is not None and match is not None and drawn is not None:
        team, names, role, driver = own.team[match], drawn.teams, own.role[match], own.driver[match]
        known |= {"teams", "roles"}
    heading = np.zeros(len(tracks))
    if tracks.heading is not None:
        heading = tracks.heading[np.arange(len(tracks)), tracks.first]
    agents = Agents(
        start=start, heading=heading, goal=goal, radius=radius,
        max_speed=np.full(len(tracks), np.inf), preferred_speed=speed,
        max_turn_rate=np.full(len(tracks), np.inf),
        dynamics=np.full(len(tracks), int(Dynamics.HOLONOMIC), np.int8), role=role, team=team,
        driver=driver,
    )  # fmt: skip
    if drawn is None:
        tolerance = GOAL_TOLERANCE if tolerance is None else tolerance
        world = _open(tracks, agents, names, tolerance)
        remarks.append("No walls are known: only contacts and distances between ids count.")
    else:
        world = _of_scenario(drawn, tracks, agents, names, tolerance)
        known |= {"walls", "horizon"} | (set() if drawn.bodies else {"movers"})
        if match is None:
            remarks.append(
                "The ids do not start where the scenario's agents do: its walls, rules and horizon"
                " are used, and nothing of its agents."
            )
        if drawn.bodies:
            remarks.append("The table holds no moving obstacles: contacts with them are unknown.")
    if options.area is not None:
        world = replace(world, measurement_area=options.area)
    if world.measurement_area is not None:
        known.add("area")
    return Setting(world, frozenset(known), tuple(remarks))


def _same_agents(tracks: Tracks, drawn: World) -> IntArray | None:
    """Return the agent (A,) that starts where each id does; None if the starts differ."""
    starts = drawn.agents.start
    if len(starts) != len(tracks) or not tracks.together:
        return None
    from scipy.spatial import cKDTree

    distance, nearest = cKDTree(starts).query(tracks.place[:, 0])
    if distance.max() > _SAME or len(set(nearest.tolist())) < len(nearest):
        return None
    found: IntArray = nearest.astype(np.int64)
    return found


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
    drawn: World, tracks: Tracks, agents: Agents, names: tuple[str, ...], tolerance: float | None
) -> World:
    steps = max(1, round(drawn.clock.horizon / tracks.dt))
    rules = drawn.rules if tolerance is None else replace(drawn.rules, goal_tolerance=tolerance)
    return replace(
        drawn, agents=agents, teams=names, bodies=(), rules=rules,
        sees=np.ones((len(names), len(names)), np.bool_),
        clock=replace(drawn.clock, dt=tracks.dt, substeps=1, steps=steps),
    )  # fmt: skip
