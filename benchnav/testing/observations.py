"""What a navigator would be told and shown in some worlds, whatever it answers.

Agents move by a script (straight at their goals), so that two ways of asking the same
navigator can be compared decision by decision.
"""

from collections.abc import Sequence
from dataclasses import fields, is_dataclass, replace
from typing import Any
from zlib import crc32

import numpy as np

from benchnav.arena.world import World
from benchnav.arrays import AnyArray, FloatArray, IntArray
from benchnav.navigation.briefing import Briefing, brief
from benchnav.navigation.command_check import said
from benchnav.navigation.navigator import Navigator, Need
from benchnav.navigation.observation import Observation
from benchnav.navigation.observe import deciding, observe
from benchnav.navigation.tracks import granted_map
from benchnav.testing.rehearsals import rehearsals_of
from benchnav.world.simulation import Simulation

FRAMES = 6


def briefings_of(
    worlds: Sequence[World], needs: frozenset[Need], rehearsals: int = 0
) -> list[Briefing]:
    """A fresh briefing of each world; its generator depends on the world's geometry alone.

    With as many made-up ``rehearsals`` as are asked for.
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
) -> list[Observation]:
    """Successive observations of all agents of B worlds, with only the sensors in ``needs``.

    Args:
        worlds: B of them, with one clock, one set of rules and one sensing.
        needs: what is sensed; maps are granted as by the track `known`, or not at all.
        rows: (B,) the rows that the worlds have; None: 0 … B-1.
        padding: how many columns of inactive agents are added.
        frames: how many observations, one decision apart.
    """
    simulation = Simulation(worlds)
    width = simulation.A + padding
    chosen = np.full((len(worlds), width), -1)
    for b, world in enumerate(worlds):
        chosen[b, : len(world.agents)] = np.arange(len(world.agents))
    maps = tuple(told.map for told in briefings_of(worlds, needs))
    seen = []
    for _ in range(frames):
        active = deciding(simulation, chosen)
        observation = observe(simulation, chosen, active, needs, maps)
        seen.append(observation if rows is None else replace(observation, rows=rows.copy()))
        simulation.step(_script(simulation), np.zeros((simulation.B, simulation.A), np.bool_))
    return seen


def _script(simulation: Simulation) -> FloatArray:
    """(B, A, 2) [m/s] at preferred speed straight at the goals."""
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
    """What a navigator commands after a reset: for each world (FRAMES, A, 2), NaN if inactive.

    It is told what it needs, and ``shown`` beyond that. Raises AssertionError where it raises,
    with the ``circumstance``.
    """
    needs = navigator.required | shown
    places = np.arange(len(worlds)) if rows is None else rows
    told = briefings_of(worlds, needs, navigator.rehearsal)
    called(navigator, circumstance, "reset", told, places.copy())
    frames = [
        masked(called(navigator, circumstance, "act", observation), observation)
        for observation in observations_of(worlds, needs, places, padding)
    ]
    return [
        np.stack([frame[b, : len(world.agents)] for frame in frames])
        for b, world in enumerate(worlds)
    ]


def called(navigator: Navigator, circumstance: str, call: str, *told: Any) -> Any:
    """What ``reset`` or ``act`` returns. Raises AssertionError, with the rule, where it raises."""
    try:
        return getattr(navigator, call)(*told)
    except Exception as error:
        name, when = type(navigator).__name__, f" {circumstance}" if circumstance else ""
        raise AssertionError(
            f"{name}.{call} must work{when}: what is kept of a world belongs under its row, which"
            f" reset is given and the observation has as `rows`. It raised {said(error)}."
        ) from error


def masked(answer: Any, observation: Observation) -> FloatArray:
    """(B, A, 2) the commands that count; NaN elsewhere."""
    command: FloatArray = np.where(observation.active[..., None], answer, np.nan)
    return command


def contents(part: Any) -> list[AnyArray]:
    """Copies of all arrays of a briefing or observation, of what it consists of too."""
    found: list[AnyArray] = []
    for f in fields(part):
        value = getattr(part, f.name)
        for item in value if isinstance(value, tuple) else (value,):
            if isinstance(item, np.ndarray):
                found.append(item.copy())
            elif is_dataclass(item):
                found += contents(item)
    return found
