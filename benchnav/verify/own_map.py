"""The maps that a navigator made itself, from running it again in the world of an episode.

They are shown only if every command is the stored one: then they are the maps of the episode.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from benchnav.arrays import FloatArray, IntArray
from benchnav.episode.episode import Episode
from benchnav.errors import BenchnavError
from benchnav.navigation.command_check import CallFailed, exception_text
from benchnav.navigation.map import Map
from benchnav.navigation.observe import deciding
from benchnav.navigation.rehearsal import Rehearsal
from benchnav.runner.rollouts.navigator_driver import Driver
from benchnav.runner.rollouts.rollout import Assignment, drivers_of
from benchnav.runner.rollouts.seeding import generator, noise_key
from benchnav.verify.resimulation import unfit
from benchnav.world.simulation import Simulation

INTERVAL = 1.0  # [s] between two maps of an agent at least


@dataclass(frozen=True)
class Production:
    """How an episode was made."""

    assignment: Assignment
    rehearsals: tuple[Rehearsal, ...] = ()  # that the navigator received


Origin = Callable[[], Production | str]
"""How an episode was made, or why its navigator cannot be run again."""


@dataclass(frozen=True, eq=False)
class OwnMaps:
    """The maps of n agents at the times at which they changed."""

    agents: IntArray  # (n,)
    maps: tuple[tuple[tuple[int, Map], ...], ...]  # for each agent (state, map), in this order


def own_maps(origin: Origin, episode: Episode, agents: IntArray) -> OwnMaps | str | None:
    """Return the maps of ``agents`` (n,), why they are unknown, or None: it makes none."""
    try:
        made = origin()
        if isinstance(made, str):
            return made
        simulation = Simulation([episode.world])
        alone = replace(made.assignment, background=(), isolated=False)
        (driver, *_) = drivers_of(alone, simulation, [made.rehearsals])
        if not driver.navigator.has_own_map:
            return None
        why = _obstacle(made, episode)
        return why or _recorded(alone, driver, episode, agents)
    except CallFailed as failed:
        return failed.reason
    except BenchnavError as error:
        return str(error).rstrip(".")
    except Exception as error:
        return f"its navigator raised {exception_text(error)}"


def _obstacle(made: Production, episode: Episode) -> str:
    """Return why the navigator cannot be run again; "" if it can."""
    if len(made.rehearsals) != made.assignment.rehearsals:
        return "not all of its rehearsals were run"
    if not episode.reproducible:
        return "a clock decides what it does"
    return unfit(episode.world, episode)


def _recorded(
    assignment: Assignment, driver: Driver, episode: Episode, agents: IntArray
) -> OwnMaps | str:
    """Return the maps, or the first time at which a command is not the stored one."""
    simulation, navigator = driver.simulation, driver.navigator
    about = (assignment.salt, assignment.scenario_hash, assignment.split, episode.identity.seed)
    driver.reset([generator(*about, 0)], noise_key(*about)[None])
    places = {int(agent): n for n, agent in enumerate(driver.chosen[0])}
    own = [int(agent) for agent in agents if int(agent) in places]
    kept: dict[int, list[tuple[int, Map]]] = {agent: [] for agent in own}
    latest: dict[int, tuple[int, Map]] = {}
    twist, dt = np.asarray(episode.twist)[None], episode.world.clock.dt
    for t in range(len(episode.requested)):
        command, stored = np.zeros_like(simulation.position), episode.requested[t]
        active = driver.chosen[0][deciding(simulation, driver.chosen)[0]]
        driver.act(command, t * dt)
        if not np.array_equal(command[0, active], stored[active]):
            return f"its commands differ from the stored ones at t = {t * dt:.1f} s"
        for agent in own:
            map = navigator.own_map(0, places[agent]) if agent in active else None
            if map is not None:
                latest[agent] = t, map
                _keep(kept[agent], t, map, round(INTERVAL / dt))
        simulation.step(stored[None], twist)
    for agent, (t, map) in latest.items():
        _keep(kept[agent], t, map, 0)
    return OwnMaps(np.array(own, np.int64), tuple(tuple(maps) for maps in kept.values()))


def _keep(maps: list[tuple[int, Map]], state: int, map: Map, interval: int) -> None:
    """Add a map that differs from the last one, unless that is too recent."""
    if not maps or (maps[-1][1] is not map and state - maps[-1][0] >= interval):
        maps.append((state, map))


def map_changes(maps: OwnMaps) -> tuple[FloatArray, list[list[tuple[int, list[int], list[int]]]]]:
    """Return all capsules once, and what changes.

    Returns:
        capsules (N, 5) of all maps: x0, y0, x1, y1, radius [m].
        For each agent: (state, rows that are added, rows that are removed).
    """
    rows: dict[tuple[float, ...], int] = {}
    changes = []
    for history in maps.maps:
        before: set[int] = set()
        own = []
        for state, map in history:
            capsules = map.capsules.round(3).tolist()
            now = {rows.setdefault(tuple(capsule), len(rows)) for capsule in capsules}
            own.append((state, sorted(now - before), sorted(before - now)))
            before = now
        changes.append(own)
    table: FloatArray = np.array(list(rows), np.float64).reshape(-1, 5)
    return table, changes
