"""The paper's state: 7 rays and 6 numbers of agent and goal; 48 numbers, 62 with movers.

A ray has a one-hot code of the object that it meets (agent, wall, static obstacle, goal), a
flag for no object, and its length. A mover hides the objects behind it, counts as no object,
and has two numbers of its own.
"""

import math
from functools import cached_property
from typing import ClassVar

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import ByteArray, FloatArray
from benchnav.envs.encoders.encoder import (
    Bodies,
    Encoder,
    Float32Array,
    Number,
    rays_of,
)
from benchnav.kernels import kernel_without_allocation
from benchnav.navigation.navigator import Need
from benchnav.navigation.observation import Observation

RAYS = 7
RANGE = 8.0  # [m] scale of lengths
SPAN = 10.0  # [m] scale of coordinates: half of the paper's arena
SPEED = 2.0  # [m/s] scale of speeds
_ONE_HOT = (Kind.AGENT, Kind.WALL, Kind.STATIC, Kind.GOAL)
_AGENT, _WALL, _STATIC, _GOAL = (int(kind) for kind in _ONE_HOT)
_DYNAMIC, _NOTHING = int(Kind.DYNAMIC), int(Kind.NOTHING)
_WORDS = {Kind.AGENT: "an agent", Kind.WALL: "a wall", Kind.STATIC: "a static obstacle",
          Kind.GOAL: "the own goal"}  # fmt: skip


class PaperEncoder(Encoder):
    """The paper's numbers with absolute positions, as printed."""

    name: ClassVar[str] = "paper"
    needs: ClassVar[frozenset[Need]] = frozenset({Need.RAYS})
    fades: ClassVar[FloatArray] = np.empty(0)  # [m] of a nearness in place of lengths, see `near`

    def __init__(self, movers: bool = True) -> None:
        self.movers = movers

    @cached_property
    def numbers(self) -> tuple[Number, ...]:
        rays = [number for ray in range(RAYS) for number in self._ray_numbers(ray)]
        movers = [number for ray in range(RAYS) for number in self._mover_numbers(ray)]
        return (*rays, *self._own_numbers(), *(movers if self.movers else ()))

    def encode(self, seen: Observation, bodies: Bodies) -> Float32Array:
        rays, (low, high) = rays_of(seen, RAYS, self.name), self._ranges
        out = np.empty((*seen.active.shape, len(low)), np.float32)
        _write_numbers(
            rays.kind, rays.distance, rays.approach, rays.across, rays.goal,
            self._own_values(seen, bodies), self.fades, low, high, self.movers, out,
        )  # fmt: skip
        return out

    @cached_property
    def _ranges(self) -> tuple[FloatArray, FloatArray]:
        return (
            np.array([n.low for n in self.numbers], float),
            np.array([n.high for n in self.numbers], float),
        )

    def _ray_numbers(self, ray: int) -> list[Number]:
        flags = [
            Number(f"ray{ray}.{kind.name.lower()}", "", 0, 1, f"it meets {_WORDS[kind]} first")
            for kind in _ONE_HOT
        ]
        length = self._length_number(f"ray{ray}.length", "its length")
        return [*flags, self._fifth_number(ray), length]

    def _fifth_number(self, ray: int) -> Number:
        return Number(f"ray{ray}.nothing", "", 0, 1, "it meets none of these within range")

    def _mover_numbers(self, ray: int) -> list[Number]:
        what = f"speed towards the agent of the mover that it meets, over {SPEED:g} m/s"
        speed = Number(f"ray{ray}.mover_speed", "m/s", -1.5, 1.5, what)
        return [speed, self._length_number(f"ray{ray}.mover_distance", "the mover's distance")]

    def _length_number(self, name: str, what: str) -> Number:
        return Number(name, "m", 0, 1, f"{what} over {RANGE:g} m, 1 if none")

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
    out = np.empty((*seen.heading.shape, 6))
    cos, sin = np.cos(seen.heading), np.sin(seen.heading)
    _write_own_frame(cos, sin, seen.position, seen.velocity, seen.goal, out)
    return out


@kernel_without_allocation
def _write_own_frame(
    cos: FloatArray, sin: FloatArray, position: FloatArray, velocity: FloatArray, goal: FloatArray,
    out: FloatArray,
) -> None:  # fmt: skip
    for b in range(cos.shape[0]):
        for i in range(cos.shape[1]):
            c, s, own = cos[b, i], sin[b, i], out[b, i]
            x, y = goal[b, i, 0] - position[b, i, 0], goal[b, i, 1] - position[b, i, 1]
            ahead, left = c * x + s * y, c * y - s * x
            own[0], own[1] = ahead / SPAN, left / SPAN
            vx, vy = velocity[b, i, 0], velocity[b, i, 1]
            own[2], own[3] = (c * vx + s * vy) / SPEED, (c * vy - s * vx) / SPEED
            distance = max(math.hypot(ahead, left), 1e-9)
            own[4], own[5] = ahead / distance, left / distance


@kernel_without_allocation
def _write_numbers(
    kind: ByteArray, distance: FloatArray, approach: FloatArray, across: FloatArray,
    goal: FloatArray, own: FloatArray, fades: FloatArray, low: FloatArray, high: FloatArray,
    movers: bool, out: Float32Array,
) -> None:  # fmt: skip
    """Write the numbers of rays (B, A, R) and of the agents themselves (B, A, 6)."""
    rays, near = kind.shape[2], len(fades) > 0
    for b in range(kind.shape[0]):
        for i in range(kind.shape[1]):
            numbers = out[b, i]
            for r in range(rays):
                hit, on_goal = kind[b, i, r], goal[b, i, r] < math.inf
                mover = hit == _DYNAMIC and not on_goal
                first = 6 * r
                numbers[first] = 1.0 if hit == _AGENT and not on_goal else 0.0
                numbers[first + 1] = 1.0 if hit == _WALL and not on_goal else 0.0
                numbers[first + 2] = 1.0 if hit == _STATIC and not on_goal else 0.0
                numbers[first + 3] = 1.0 if on_goal or hit == _GOAL else 0.0
                if near:
                    speed = across[b, i, r] if hit == _DYNAMIC else 0.0
                    numbers[first + 4] = _clipped(speed / SPEED, low, high, first + 4)
                else:
                    numbers[first + 4] = 1.0 if mover or (hit == _NOTHING and not on_goal) else 0.0
                length = goal[b, i, r] if on_goal else RANGE if mover else distance[b, i, r]
                numbers[first + 5] = _clipped(_length_value(length, fades), low, high, first + 5)
                if movers:
                    last = 6 * rays + 6 + 2 * r
                    speed = approach[b, i, r] if hit == _DYNAMIC else 0.0
                    numbers[last] = _clipped(speed / SPEED, low, high, last)
                    length = distance[b, i, r] if hit == _DYNAMIC else RANGE
                    numbers[last + 1] = _clipped(_length_value(length, fades), low, high, last + 1)
            for k in range(6):
                numbers[6 * rays + k] = _clipped(own[b, i, k], low, high, 6 * rays + k)


@kernel_without_allocation
def _clipped(value: float, low: FloatArray, high: FloatArray, k: int) -> float:
    return float(min(max(value, low[k]), high[k]))


@kernel_without_allocation
def _length_value(length: float, fades: FloatArray) -> float:
    """Return the number of a length [m], of which `RANGE` says that there is nothing."""
    if len(fades) == 0:
        return length / RANGE
    near = 0.0
    if length < RANGE:
        for fade in fades:
            near += math.exp(-length / fade)
    return near
