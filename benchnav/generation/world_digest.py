"""Digests of worlds, to find equal ones; the count of redraws is left out."""

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from benchnav.arena.body import Body
from benchnav.arena.motion_limits import MotionLimits
from benchnav.arena.world import World
from benchnav.generation.build import build
from benchnav.scenario.scenario import Scenario
from benchnav.scenario.terms import SPLITS

Place = tuple[str, int]  # split, seed


def world_digest(world: World) -> str:
    """Return 16 hex digits, equal for two worlds exactly if all their numbers are equal."""
    digest = hashlib.sha256()
    for chunk in _chunks(world):
        digest.update(chunk)
    return digest.hexdigest()[:16]


def _chunks(part: Any) -> Iterator[bytes]:
    if isinstance(part, np.ndarray):
        yield f"{part.dtype.str}{part.shape}".encode()
        yield np.ascontiguousarray(part).tobytes()
    elif is_dataclass(part):
        out = part.without_limit() if isinstance(part, MotionLimits) else frozenset({"redraws"})
        if isinstance(part, Body) and not part.person:
            out = frozenset({"person"})  # worlds of earlier versions have no people
        for item in fields(part):
            if item.name not in out:
                yield item.name.encode()
                yield from _chunks(getattr(part, item.name))
    elif isinstance(part, tuple):
        yield f"({len(part)}".encode()
        for value in part:
            yield from _chunks(value)
    else:
        yield repr(part).encode()


def is_random(scenario: Scenario) -> bool:
    """Whether the world depends on seed or split."""
    digests = {world_digest(build(scenario, split, seed)) for split in SPLITS for seed in (0, 1)}
    return len(digests) > 1


def coincidences(scenario: Scenario, seeds: Sequence[int]) -> list[tuple[Place, ...]]:
    """Return groups of two or more equal worlds, as (split, seed), over all three splits."""
    found: dict[str, list[Place]] = {}
    for split in SPLITS:
        for seed in seeds:
            found.setdefault(world_digest(build(scenario, split, seed)), []).append((split, seed))
    return [tuple(group) for group in found.values() if len(group) > 1]
