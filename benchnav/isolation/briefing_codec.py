"""Briefings ↔ fields of a frame.

Data whose length differs from world to world (agents, solids, rehearsals) is concatenated; a
field holds the length of each part.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchnav.arena.agent_bodies import PLAIN_BODY
from benchnav.arrays import IntArray
from benchnav.isolation.map_codec import decode_maps, encode_maps
from benchnav.isolation.ragged_codec import counts, slices
from benchnav.navigation.briefing import Briefing
from benchnav.navigation.randomness.briefing_seed import hashed_generator, seed_bytes
from benchnav.navigation.rehearsal import Rehearsal

_WORLD_FIELDS = ("dt", "horizon", "goal_tolerance", "decision_budget")
_AGENT_FIELDS = (
    "start", "heading", "goal", "radius", "max_speed", "preferred_speed", "max_turn_rate",
    "dynamics", "role", "team",
)  # fmt: skip
_LEADERS = ("agent", "last", "arrival", "collided")


def encode_briefings(briefings: Sequence[Briefing], rows: IntArray) -> dict[str, Any]:
    """Return the frame fields of ``briefings`` (N,) for the worlds ``rows`` (N,)."""
    fields: dict[str, Any] = {"rows": np.asarray(rows, np.int64)}
    for name in _WORLD_FIELDS:
        values = [getattr(briefing, name) for briefing in briefings]
        fields[name] = np.array([np.nan if v is None else v for v in values], float)
    fields["agents"] = counts(len(briefing) for briefing in briefings)
    for name in (*_AGENT_FIELDS, *PLAIN_BODY):
        fields[name] = np.concatenate([getattr(briefing, name) for briefing in briefings])
    seeds = b"".join(seed_bytes(briefing.rng) for briefing in briefings)
    fields["seed"] = np.frombuffer(seeds, np.uint8).reshape(len(briefings), -1)
    fields |= encode_maps([briefing.map for briefing in briefings])
    return fields | _encode_rehearsals([briefing.rehearsals for briefing in briefings])


def decode_briefings(fields: dict[str, Any]) -> list[Briefing]:
    """Return the briefings that `encode_briefings` encoded, with equal numbers and generators."""
    maps, rehearsals = decode_maps(fields), _decode_rehearsals(fields)
    briefings = []
    for n, agents in enumerate(slices(fields["agents"])):
        clock = [None if np.isnan(v := float(fields[name][n])) else v for name in _WORLD_FIELDS]
        agent_fields = [fields[name][agents].copy() for name in _AGENT_FIELDS]
        rng = hashed_generator(fields["seed"][n].tobytes())
        limits = {name: fields[name][agents].copy() for name in PLAIN_BODY}
        create: Any = Briefing
        briefings.append(create(*clock, *agent_fields, maps[n], rng, rehearsals[n], **limits))
    return briefings


def _encode_rehearsals(grants: Sequence[tuple[Rehearsal, ...]]) -> dict[str, Any]:
    fields: dict[str, Any] = {"rehearsals": counts(map(len, grants))}
    together = [rehearsal for grant in grants for rehearsal in grant]
    if together:
        fields["rehearsal.dt"] = np.array([rehearsal.dt for rehearsal in together])
        fields["rehearsal.leaders"] = counts(map(len, together))
        fields["rehearsal.times"] = counts(len(rehearsal.position) for rehearsal in together)
        for name in _LEADERS:
            fields[f"rehearsal.{name}"] = np.concatenate([getattr(r, name) for r in together])
        fields["rehearsal.position"] = np.vstack([r.position.reshape(-1, 2) for r in together])
    return fields


def _decode_rehearsals(fields: dict[str, Any]) -> list[tuple[Rehearsal, ...]]:
    if "rehearsal.dt" not in fields:
        return [()] * len(fields["rehearsals"])
    leaders, times = fields["rehearsal.leaders"], fields["rehearsal.times"]
    together = []
    for k, (part, places) in enumerate(zip(slices(leaders), slices(leaders * times), strict=True)):
        agent, last, arrival, collided = (
            fields[f"rehearsal.{name}"][part].copy() for name in _LEADERS
        )
        position = fields["rehearsal.position"][places].reshape(times[k], leaders[k], 2).copy()
        dt = float(fields["rehearsal.dt"][k])
        together.append(Rehearsal(dt, agent, position, last, arrival, collided))
    return [tuple(together[grant]) for grant in slices(fields["rehearsals"])]
