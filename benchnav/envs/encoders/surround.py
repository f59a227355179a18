"""An encoder of all directions: a scan of static edges, and the nearest agents and movers.

The encoder casts the scan against the edges that the agent senses, with the agent's disc.
Agents and movers follow one by one, nearest first, with their velocity and the
collision probability of Eq. 24.
"""

import math
from functools import cached_property
from typing import ClassVar

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arrays import ByteArray, FloatArray, IntArray
from benchnav.envs.collision_probability import probability
from benchnav.envs.encoders.encoder import Bodies, Encoder, Float32Array, Number, within
from benchnav.envs.encoders.paper import SPEED, own_frame
from benchnav.geometry.capsule import capsule_time
from benchnav.kernels import kernel
from benchnav.navigation.navigator import Need
from benchnav.navigation.observation import Observation
from benchnav.sensors.readings import Edges, Neighbours

DIRECTIONS = 24
OTHERS = 6
RANGE = 8.0  # [m] of the scan
FADE = 2.0  # [m] distance over which nearness falls by the factor e
_EACH = 8  # numbers per other
MOVER = int(Kind.DYNAMIC)


class SurroundEncoder(Encoder):
    """8 numbers of goal and agent, 24 of the scan, 8 for each of the 6 nearest others."""

    name: ClassVar[str] = "surround"
    needs: ClassVar[frozenset[Need]] = frozenset({Need.NEIGHBOURS, Need.EDGES})
    others: ClassVar[int] = OTHERS

    @cached_property
    def numbers(self) -> tuple[Number, ...]:
        return self._numbers()

    def _numbers(self) -> tuple[Number, ...]:
        own = (
            Number("p_g.ahead", "m", -3, 3, "goal ahead of the agent over 10 m"),
            Number("p_g.left", "m", -3, 3, "goal to the left of the agent over 10 m"),
            Number("v_a.ahead", "m/s", -1.5, 1.5, f"own velocity ahead over {SPEED:g} m/s"),
            Number("v_a.left", "m/s", -1.5, 1.5, f"own velocity to the left over {SPEED:g} m/s"),
            Number("goal.cos", "", -1, 1, "cosine of the goal's bearing"),
            Number("goal.sin", "", -1, 1, "sine of the goal's bearing"),
            Number("goal.near", "m", 0, 1, f"exp(-distance of the goal / {FADE:g} m)"),
            Number("speed.max", "m/s", 0, 1.5, f"own top speed over {SPEED:g} m/s"),
        )
        scan = tuple(
            Number(
                f"scan{k}.near", "m", 0, 1,
                f"exp(-free way of its disc / {FADE:g} m), {k * 360 / DIRECTIONS:g}° to the left",
            )
            for k in range(DIRECTIONS)
        )  # fmt: skip
        return (*own, *scan, *(n for k in range(self.others) for n in _other_numbers(k)))

    def encode(self, seen: Observation, bodies: Bodies) -> Float32Array:
        assert seen.neighbours is not None  # noqa: S101 - declared in `needs`
        assert seen.edges is not None  # noqa: S101
        shape = seen.heading.shape
        scan = np.zeros((*shape, DIRECTIONS))
        others = np.zeros((*shape, self.others * _EACH))
        agents = math.prod(shape)
        if agents:
            _scan(
                seen.position.reshape(agents, 2), seen.heading.reshape(agents),
                bodies.radius.reshape(agents), *edge_numbers(seen.edges, agents),
                scan.reshape(agents, DIRECTIONS),
            )  # fmt: skip
            _others(
                seen.position.reshape(agents, 2), seen.velocity.reshape(agents, 2),
                seen.heading.reshape(agents), bodies.radius.reshape(agents),
                *neighbour_numbers(seen.neighbours, agents), others.reshape(agents, -1),
            )  # fmt: skip
        own = own_frame(seen)
        distance = np.linalg.norm(seen.goal - seen.position, axis=-1)
        more = np.stack([np.exp(-distance / FADE), bodies.max_speed / SPEED], axis=-1)
        parts = [own, more, scan, others, *self._further(seen, bodies)]
        return within(self.numbers, np.concatenate(parts, axis=-1))

    def _further(self, seen: Observation, bodies: Bodies) -> list[FloatArray]:
        """Return further numbers (B, A, …) of an encoder that has more."""
        return []


def _other_numbers(k: int) -> list[Number]:
    return [
        Number(f"other{k}.cos", "", -1, 1, "cosine of its bearing"),
        Number(f"other{k}.sin", "", -1, 1, "sine of its bearing"),
        Number(f"other{k}.close", "m", 0, 1, "1 - gap / 10 m, 0 if there is none"),
        Number(f"other{k}.near", "m", 0, 1, "exp(-gap / 1 m), 0 if there is none"),
        Number(f"other{k}.v_ahead", "m/s", -2, 2, f"its velocity less the own, over {SPEED:g} m/s"),
        Number(f"other{k}.v_left", "m/s", -2, 2, f"its velocity less the own, over {SPEED:g} m/s"),
        Number(f"other{k}.p", "", 0, 1, "collision probability, Eq. 24"),
        Number(f"other{k}.mover", "", 0, 1, "it never yields"),
    ]


def edge_numbers(edges: Edges, agents: int) -> tuple[FloatArray, FloatArray, IntArray]:
    """Return start, end and count of the edges of ``agents`` agents."""
    return (
        edges.start.reshape(agents, -1, 2), edges.end.reshape(agents, -1, 2),
        edges.count.reshape(agents),
    )  # fmt: skip


def neighbour_numbers(
    seen: Neighbours, agents: int
) -> tuple[FloatArray, FloatArray, FloatArray, ByteArray, IntArray]:
    """Return position, velocity, radius, kind and count of the neighbours of ``agents`` agents."""
    return (
        seen.position.reshape(agents, -1, 2), seen.velocity.reshape(agents, -1, 2),
        seen.radius.reshape(agents, -1), seen.kind.reshape(agents, -1), seen.count.reshape(agents),
    )  # fmt: skip


@kernel
def _scan(
    position: FloatArray, heading: FloatArray, radius: FloatArray, first: FloatArray,
    second: FloatArray, count: IntArray, out: FloatArray,
) -> None:  # fmt: skip
    for i in range(len(position)):
        x, y = position[i, 0], position[i, 1]
        for k in range(DIRECTIONS):
            angle = heading[i] + 2.0 * math.pi * k / DIRECTIONS
            dx, dy = math.cos(angle), math.sin(angle)
            best = RANGE
            for e in range(count[i]):
                t = capsule_time(
                    x, y, dx, dy, radius[i], best,
                    first[i, e, 0], first[i, e, 1], second[i, e, 0], second[i, e, 1],
                )  # fmt: skip
                best = min(best, t)
            out[i, k] = math.exp(-best / FADE) if best < RANGE else 0.0


@kernel
def _others(
    position: FloatArray, velocity: FloatArray, heading: FloatArray, radius: FloatArray,
    other_position: FloatArray, other_velocity: FloatArray, other_radius: FloatArray,
    kind: ByteArray, count: IntArray, out: FloatArray,
) -> None:  # fmt: skip
    for i in range(len(position)):
        c, s = math.cos(heading[i]), math.sin(heading[i])
        for k in range(min(count[i], out.shape[1] // _EACH)):
            x = other_position[i, k, 0] - position[i, 0]
            y = other_position[i, k, 1] - position[i, 1]
            u = other_velocity[i, k, 0] - velocity[i, 0]
            v = other_velocity[i, k, 1] - velocity[i, 1]
            distance = max(math.sqrt(x * x + y * y), 1e-9)
            reach = radius[i] + other_radius[i, k]
            gap = max(distance - reach, 0.0)
            row = out[i, _EACH * k : _EACH * (k + 1)]
            row[0], row[1] = (c * x + s * y) / distance, (c * y - s * x) / distance
            row[2], row[3] = max(1.0 - gap / 10.0, 0.0), math.exp(-gap)
            row[4], row[5] = (c * u + s * v) / SPEED, (c * v - s * u) / SPEED
            row[6] = probability(x, y, -u, -v, reach)
            row[7] = 1.0 if kind[i, k] == MOVER else 0.0
