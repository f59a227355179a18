"""The paper's state: 7 rays and 6 numbers of agent and goal; 48 numbers, 62 with movers.

A ray has a one-hot code of the object that it meets (agent, wall, static obstacle, goal), a
flag for no object, and its length. A mover hides the objects behind it, counts as no object,
and has two numbers of its own.
"""

from functools import cached_property
from typing import ClassVar

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import FloatArray
from benchnav.envs.encoders.encoder import (
    Bodies,
    Encoder,
    Float32Array,
    Number,
    ahead_aside,
    rays_of,
    within,
)
from benchnav.navigation.navigator import Need
from benchnav.navigation.observation import Observation
from benchnav.sensors.readings import Rays

RAYS = 7
RANGE = 8.0  # [m] scale of lengths
SPAN = 10.0  # [m] scale of coordinates: half of the paper's arena
SPEED = 2.0  # [m/s] scale of speeds
_ONE_HOT = (Kind.AGENT, Kind.WALL, Kind.STATIC, Kind.GOAL)
_WORDS = {Kind.AGENT: "an agent", Kind.WALL: "a wall", Kind.STATIC: "a static obstacle",
          Kind.GOAL: "the own goal"}  # fmt: skip


class PaperEncoder(Encoder):
    """The paper's numbers with absolute positions, as printed."""

    name: ClassVar[str] = "paper"
    needs: ClassVar[frozenset[Need]] = frozenset({Need.RAYS})

    def __init__(self, movers: bool = True) -> None:
        self.movers = movers

    @cached_property
    def numbers(self) -> tuple[Number, ...]:
        rays = [number for ray in range(RAYS) for number in self._ray_numbers(ray)]
        movers = [number for ray in range(RAYS) for number in self._mover_numbers(ray)]
        return (*rays, *self._own_numbers(), *(movers if self.movers else ()))

    def encode(self, seen: Observation, bodies: Bodies) -> Float32Array:
        rays = rays_of(seen, RAYS, self.name)
        parts = [self._ray_values(rays), self._own_values(seen, bodies)]
        if self.movers:
            parts.append(self._mover_values(rays))
        return within(self.numbers, np.concatenate(parts, axis=-1))

    def _ray_numbers(self, ray: int) -> list[Number]:
        flags = [
            Number(f"ray{ray}.{kind.name.lower()}", "", 0, 1, f"it meets {_WORDS[kind]} first")
            for kind in _ONE_HOT
        ]
        nothing = Number(f"ray{ray}.nothing", "", 0, 1, "it meets none of these within range")
        return [*flags, nothing, self._length_number(f"ray{ray}.length", "its length")]

    def _mover_numbers(self, ray: int) -> list[Number]:
        what = f"speed towards the agent of the mover that it meets, over {SPEED:g} m/s"
        speed = Number(f"ray{ray}.mover_speed", "m/s", -1.5, 1.5, what)
        return [speed, self._length_number(f"ray{ray}.mover_distance", "the mover's distance")]

    def _ray_values(self, rays: Rays) -> FloatArray:
        goal = np.isfinite(rays.goal)
        kind = np.where(goal, int(Kind.GOAL), rays.kind)
        mover = kind == int(Kind.DYNAMIC)
        flags = [(kind == int(k)).astype(float) for k in _ONE_HOT]
        nothing = (mover | (kind == int(Kind.NOTHING))).astype(float)
        length = np.where(goal, rays.goal, np.where(mover, RANGE, rays.distance))
        values = np.stack([*flags, nothing, self._length_values(length)], axis=-1)
        return values.reshape(*values.shape[:2], -1)

    def _mover_values(self, rays: Rays) -> FloatArray:
        mover = rays.kind == int(Kind.DYNAMIC)
        speed = np.where(mover, rays.approach, 0.0) / SPEED
        length = self._length_values(np.where(mover, rays.distance, RANGE))
        values = np.stack([speed, length], axis=-1)
        return values.reshape(*values.shape[:2], -1)

    def _length_number(self, name: str, what: str) -> Number:
        return Number(name, "m", 0, 1, f"{what} over {RANGE:g} m, 1 if none")

    def _length_values(self, length: FloatArray) -> FloatArray:
        """Return the numbers of lengths [m], which are at most `RANGE`."""
        return length / RANGE

    def _own_numbers(self) -> tuple[Number, ...]:
        return (
            Number("p_a.x", "m", -3, 3, f"own position over {SPAN:g} m"),
            Number("p_a.y", "m", -3, 3, f"own position over {SPAN:g} m"),
            Number("v_a.x", "m/s", -1.5, 1.5, f"own velocity over {SPEED:g} m/s"),
            Number("v_a.y", "m/s", -1.5, 1.5, f"own velocity over {SPEED:g} m/s"),
            Number("p_g.x", "m", -3, 3, f"goal position over {SPAN:g} m"),
            Number("p_g.y", "m", -3, 3, f"goal position over {SPAN:g} m"),
        )

    def _own_values(self, seen: Observation, bodies: Bodies) -> FloatArray:
        parts = [seen.position / SPAN, seen.velocity / SPEED, seen.goal / SPAN]
        return np.concatenate(parts, axis=-1)


class EgoEncoder(PaperEncoder):
    """The paper's numbers with goal and velocity in the agent's own frame, of equal size."""

    name: ClassVar[str] = "ego"

    def _own_numbers(self) -> tuple[Number, ...]:
        return (
            Number("p_g.ahead", "m", -3, 3, f"goal ahead of the agent over {SPAN:g} m"),
            Number("p_g.left", "m", -3, 3, f"goal to the left of the agent over {SPAN:g} m"),
            Number("v_a.ahead", "m/s", -1.5, 1.5, f"own velocity ahead over {SPEED:g} m/s"),
            Number("v_a.left", "m/s", -1.5, 1.5, f"own velocity to the left over {SPEED:g} m/s"),
            Number("goal.cos", "", -1, 1, "cosine of the goal's bearing"),
            Number("goal.sin", "", -1, 1, "sine of the goal's bearing"),
        )

    def _own_values(self, seen: Observation, bodies: Bodies) -> FloatArray:
        return own_frame(seen)


def own_frame(seen: Observation) -> FloatArray:
    """Return goal and velocity (B, A, 6) in the agent's own frame, for `EgoEncoder`."""
    goal = ahead_aside(seen.heading, seen.goal - seen.position)
    velocity = ahead_aside(seen.heading, seen.velocity)
    distance = np.hypot(goal[..., 0], goal[..., 1])[..., None]
    return np.concatenate([goal / SPAN, velocity / SPEED, goal / np.maximum(distance, 1e-9)], -1)
