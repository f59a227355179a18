"""Briefings ↔ the fields of a frame.

What differs in length from world to world (agents, solids, rehearsals) is put one after
another, with a field that counts how much belongs to each.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchnav.arrays import IntArray
from benchnav.isolation.map_codec import charted, maps_of
from benchnav.isolation.ragged_codec import counts, parts
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.randomness.briefing_seed import hashed_generator, seed_bytes
from benchnav.navigation.rehearsal import Rehearsal

_CLOCK = ("dt", "horizon", "goal_tolerance", "decision_budget")
_AGENTS = (
    "start", "heading", "goal", "radius", "max_speed", "preferred_speed", "max_turn_rate",
    "dynamics", "role", "team",
)  # fmt: skip
_LED = ("agent", "last", "arrival", "collided")


def told(briefings: Sequence[Briefing], rows: IntArray) -> dict[str, Any]:
    """The fields of ``briefings`` (N,) for the worlds ``rows`` (N,)."""
    fields: dict[str, Any] = {"rows": np.asarray(rows, np.int64)}
    for name in _CLOCK:
        values = [getattr(briefing, name) for briefing in briefings]
        fields[name] = np.array([np.nan if v is None else v for v in values], float)
    fields["agents"] = counts(len(briefing) for briefing in briefings)
    for name in _AGENTS:
        fields[name] = np.concatenate([getattr(briefing, name) for briefing in briefings])
    seeds = b"".join(seed_bytes(briefing.rng) for briefing in briefings)
    fields["seed"] = np.frombuffer(seeds, np.uint8).reshape(len(briefings), -1)
    fields |= charted([briefing.map for briefing in briefings])
    return fields | _rehearsed([briefing.rehearsals for briefing in briefings])


def briefings_of(fields: dict[str, Any]) -> list[Briefing]:
    """The briefings that `told` made ``fields`` of: the same numbers, and generators alike."""
    maps, rehearsals = maps_of(fields), _rehearsals_of(fields)
    briefings = []
    for n, agents in enumerate(parts(fields["agents"])):
        clock = [None if np.isnan(v := float(fields[name][n])) else v for name in _CLOCK]
        crew = [fields[name][agents].copy() for name in _AGENTS]
        rng = hashed_generator(fields["seed"][n].tobytes())
        made: Any = Briefing
        briefings.append(made(*clock, *crew, maps[n], rng, rehearsals[n]))
    return briefings


def _rehearsed(grants: Sequence[tuple[Rehearsal, ...]]) -> dict[str, Any]:
    fields: dict[str, Any] = {"rehearsals": counts(map(len, grants))}
    every = [rehearsal for grant in grants for rehearsal in grant]
    if every:
        fields["rehearsal.dt"] = np.array([rehearsal.dt for rehearsal in every])
        fields["rehearsal.leaders"] = counts(map(len, every))
        fields["rehearsal.times"] = counts(len(rehearsal.position) for rehearsal in every)
        for name in _LED:
            fields[f"rehearsal.{name}"] = np.concatenate([getattr(r, name) for r in every])
        fields["rehearsal.position"] = np.vstack([r.position.reshape(-1, 2) for r in every])
    return fields


def _rehearsals_of(fields: dict[str, Any]) -> list[tuple[Rehearsal, ...]]:
    if "rehearsal.dt" not in fields:
        return [()] * len(fields["rehearsals"])
    leaders, times = fields["rehearsal.leaders"], fields["rehearsal.times"]
    every = []
    for k, (led, places) in enumerate(zip(parts(leaders), parts(leaders * times), strict=True)):
        agent, last, arrival, collided = (fields[f"rehearsal.{name}"][led].copy() for name in _LED)
        position = fields["rehearsal.position"][places].reshape(times[k], leaders[k], 2).copy()
        dt = float(fields["rehearsal.dt"][k])
        every.append(Rehearsal(dt, agent, position, last, arrival, collided))
    return [tuple(every[grant]) for grant in parts(fields["rehearsals"])]
