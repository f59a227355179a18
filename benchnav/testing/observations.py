"""Briefings and observations of some worlds that do not depend on the commands.

Agents move by a script (straight to their goals), so that two ways of calling the same
navigator can be compared decision by decision.
"""

from collections.abc import Sequence
from dataclasses import fields, is_dataclass, replace
from typing import Any
from zlib import crc32

import numpy as np

from benchnav.arena.noise import Noise
from benchnav.arena.world import World
from benchnav.arrays import AnyArray, FloatArray, IntArray
from benchnav.navigation.briefing import Briefing, brief
from benchnav.navigation.command_check import exception_text
from benchnav.navigation.navigator import Navigator, Need
from benchnav.navigation.observation import Observation
from benchnav.navigation.observe import deciding, observe
from benchnav.navigation.tracks import granted_map
from benchnav.sensors.noise.noisy_senses import NoisySenses
from benchnav.testing.rehearsals import rehearsals_of
from benchnav.world.simulation import Simulation

FRAMES = 6


def briefings_of(
    worlds: Sequence[World], needs: frozenset[Need], rehearsals: int = 0
) -> list[Briefing]:
    """Return a new briefing of each world, with ``rehearsals`` synthetic rehearsals.

    Its generator depends only on the world's geometry.
    """
    track = "known" if Need.MAP in needs else "unknown"
    return [
        brief(
            world.agents,
            np.arange(len(world.agents)),
            dt=world.clock.dt,
            horizon=world.clock.horizon,
            goal_tolerance=world.rules.goal_tolerance,
            decision_budget=world.clock.decision_budget,
            map=granted_map(world, track),
            rng=np.random.default_rng(crc32(world.solids[-1].capsules.tobytes())),
            rehearsals=rehearsals_of(world, rehearsals),
        )
        for world in worlds
    ]


def observations_of(
    worlds: Sequence[World],
    needs: frozenset[Need],
    rows: IntArray | None = None,
    padding: int = 0,
    frames: int = FRAMES,
    noise: Noise | None = None,
) -> list[Observation]:
    """Return successive observations of all agents of B worlds, with the sensors in ``needs``.

    Args:
        worlds: B worlds with one clock, one set of rules and one sensing.
        needs: the sensors to compute, and whether the maps of the track `known` are granted.
        rows: (B,) the rows of the worlds; None: 0 … B-1.
        padding: number of additional columns of inactive agents.
        frames: number of observations, one decision apart.
        noise: of the senses; None: they are exact.
    """
    simulation = Simulation(worlds)
    width = simulation.A + padding
    chosen = np.full((len(worlds), width), -1)
    for b, world in enumerate(worlds):
        chosen[b, : len(world.agents)] = np.arange(len(world.agents))
    maps = tuple(briefing.map for briefing in briefings_of(worlds, needs))
    senses = None if noise is None else _noisy_senses(simulation, chosen, noise)
    observations = []
    for _ in range(frames):
        active = deciding(simulation, chosen)
        observation = observe(simulation, chosen, active, needs, maps, senses)
        if rows is not None:
            observation = replace(observation, rows=rows.copy())
        observations.append(observation)
        simulation.step(_script(simulation), np.zeros((simulation.B, simulation.A), np.bool_))
    return observations


def _noisy_senses(simulation: Simulation, chosen: IntArray, noise: Noise) -> NoisySenses:
    senses, rows = NoisySenses(simulation, chosen, noise), np.arange(simulation.B)
    senses.begin(rows, np.stack([rows, rows], axis=1).astype(np.uint64))
    return senses


def _script(simulation: Simulation) -> FloatArray:
    """Return velocities (B, A, 2) [m/s] at preferred speed straight to the goals."""
    way = simulation.goal - simulation.position
    distance = np.sqrt(np.sum(way * way, axis=2, keepdims=True))
    speed = simulation.agents["preferred_speed"][..., None]
    velocity: FloatArray = speed * way / np.maximum(distance, 1e-9)
    return velocity


def answers_of(
    navigator: Navigator,
    worlds: Sequence[World],
    rows: IntArray | None = None,
    padding: int = 0,
    shown: frozenset[Need] = frozenset(),
    circumstance: str = "",
) -> list[FloatArray]:
    """Return the commands after a reset: for each world (FRAMES, A, 2), NaN if inactive.

    The navigator gets the inputs that it needs, and those in ``shown``. Raises AssertionError,
    with the ``circumstance``, if the navigator raises.
    """
    needs = navigator.required | shown
    places = np.arange(len(worlds)) if rows is None else rows
    briefings = briefings_of(worlds, needs, navigator.rehearsal)
    called(navigator, circumstance, "reset", briefings, places.copy())
    frames = [
        masked(called(navigator, circumstance, "act", observation), observation)
        for observation in observations_of(worlds, needs, places, padding)
    ]
    return [
        np.stack([frame[b, : len(world.agents)] for frame in frames])
        for b, world in enumerate(worlds)
    ]


def called(navigator: Navigator, circumstance: str, call: str, *arguments: Any) -> Any:
    """Call ``reset`` or ``act``. Raises AssertionError, with the rule, if the call raises."""
    try:
        return getattr(navigator, call)(*arguments)
    except Exception as error:
        name, when = type(navigator).__name__, f" {circumstance}" if circumstance else ""
        raise AssertionError(
            f"{name}.{call} must work{when}: what is kept of a world belongs under its row, which"
            f" reset is given and the observation has as `rows`. It raised {exception_text(error)}."
        ) from error


def masked(answer: Any, observation: Observation) -> FloatArray:
    """Return the commands (B, A, 2) of active agents; NaN for others."""
    command: FloatArray = np.where(observation.active[..., None], answer, np.nan)
    return command


def contents(part: Any) -> list[AnyArray]:
    """Return copies of all arrays of a briefing or observation, including nested parts."""
    found: list[AnyArray] = []
    for f in fields(part):
        value = getattr(part, f.name)
        for item in value if isinstance(value, tuple) else (value,):
            if isinstance(item, np.ndarray):
                found.append(item.copy())
            elif is_dataclass(item):
                found += contents(item)
    return found
