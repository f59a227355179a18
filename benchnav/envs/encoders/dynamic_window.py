"""`PanoramaEncoder`, and when each command of a lattice would lead to a contact.

The commands are a fixed lattice of speeds and turn rates, as in the search space of the dynamic
window approach (Fox, Burgard and Thrun, The dynamic window approach to collision avoidance, 1997),
but without limits of acceleration. A command is held for a while, then the agent drives straight
on; the others keep their velocity (Fiorini and Shiller, Motion planning in dynamic environments
using velocity obstacles, 1998).
"""

import math
from typing import ClassVar

import numpy as np

from benchnav.arrays import ByteArray, FloatArray, IntArray
from benchnav.envs.encoders.encoder import Bodies, Number
from benchnav.envs.encoders.panorama import PanoramaEncoder
from benchnav.envs.encoders.surround import MOVER, edge_numbers, neighbour_numbers
from benchnav.geometry.capsule import capsule_time, disc_time
from benchnav.kernels import kernel, kernel_without_allocation
from benchnav.navigation.observation import Observation

SPEEDS = 5  # from 0 to the top speed
TURNS = 9  # from the greatest turn rate to the right, to the greatest to the left
HELD = 0.3  # [s] shortest time for which a command is held, and of a straight piece of its arc
LONG = 3  # the longer time is this multiple of it
MARGIN = 0.05  # [m] a smaller gap counts as contact
FAR = 4.0  # [s] horizon
SOON = 1.5  # [s] decay time of the numbers
_COMMANDS = SPEEDS * TURNS


class DynamicWindowEncoder(PanoramaEncoder):
    """`PanoramaEncoder`, then 45 numbers ``short``, 45 ``long`` and 45 ``back``: one a command.

    Command 9 a + b has the speed a / 4 of the top speed, and the turn rate b / 4 - 1 of the
    greatest one, to the left. ``short`` and ``long`` are about contacts with edges and others,
    ``back`` about those with movers, if they turn back now. A contact after the horizon of 4 s
    gives 0; the goal does not end the prediction.
    """

    name: ClassVar[str] = "dynamic-window"

    def _numbers(self) -> tuple[Number, ...]:
        soon = f"exp(-time until contact / {SOON:g} s)"
        kinds = {
            "short": f"{soon}, command {{}} held for {HELD:g} s",
            "long": f"{soon}, command {{}} held for {LONG * HELD:g} s",
            "back": "as short, with movers only, which all turn back now",
        }
        window = (
            Number(f"window{k}.{kind}", "s", 0, 1, meaning.format(k))
            for kind, meaning in kinds.items()
            for k in range(_COMMANDS)
        )
        return (*super()._numbers(), *window)

    def _further(self, seen: Observation, bodies: Bodies) -> list[FloatArray]:
        assert seen.neighbours is not None  # noqa: S101 - declared in `needs`
        assert seen.edges is not None  # noqa: S101
        shape = seen.heading.shape
        out = np.zeros((*shape, 3 * _COMMANDS))
        agents = math.prod(shape)
        if agents:
            _window(
                seen.position.reshape(agents, 2), seen.heading.reshape(agents),
                bodies.radius.reshape(agents), bodies.max_speed.reshape(agents),
                bodies.max_turn_rate.reshape(agents),
                *neighbour_numbers(seen.neighbours, agents), *edge_numbers(seen.edges, agents),
                out.reshape(agents, -1),
            )  # fmt: skip
        return [*super()._further(seen, bodies), out]


@kernel
def _window(
    position: FloatArray, heading: FloatArray, radius: FloatArray, top: FloatArray,
    turn: FloatArray, other: FloatArray, velocity: FloatArray, other_radius: FloatArray,
    kind: ByteArray, others: IntArray, first: FloatArray, second: FloatArray, edges: IntArray,
    out: FloatArray,
) -> None:  # fmt: skip
    """Set ``out`` (N, 3 · 45) to the nearness in time of the first contact of each command."""
    for i in range(len(position)):
        for command in range(_COMMANDS):
            v = top[i] * (command // TURNS) / (SPEEDS - 1)
            w = turn[i] * (2.0 * (command % TURNS) / (TURNS - 1) - 1.0)
            for k in range(3):
                cell = k * _COMMANDS + command
                if 0 < command < TURNS:  # standing, whatever the turn rate
                    out[i, cell] = out[i, k * _COMMANDS]
                    continue
                time = _contact(
                    position[i], heading[i], v, w, LONG if k == 1 else 1, k == 2, radius[i],
                    other[i], velocity[i], other_radius[i], kind[i], others[i], first[i],
                    second[i], edges[i],
                )  # fmt: skip
                out[i, cell] = math.exp(-time / SOON) if time < FAR else 0.0


@kernel_without_allocation
def _contact(
    position: FloatArray, heading: float, v: float, w: float, pieces: int, back: bool,
    radius: float, other: FloatArray, velocity: FloatArray, other_radius: FloatArray,
    kind: ByteArray, others: int, first: FloatArray, second: FloatArray, edges: int,
) -> float:  # fmt: skip
    """Return the time [s] of the first contact of the command, held for ``pieces`` of 0.3 s."""
    x, y, angle = position[0], position[1], heading
    for piece in range(pieces + 1):
        start = piece * HELD
        left = HELD if piece < pieces else FAR - start
        middle = angle + (0.5 * w * HELD if piece < pieces else 0.0)
        u, s = v * math.cos(middle), v * math.sin(middle)
        best = math.inf
        for j in range(others):
            if back and kind[j] != MOVER:
                continue
            sign = -1.0 if back else 1.0
            p, q = sign * velocity[j, 0], sign * velocity[j, 1]
            best = min(
                best,
                disc_time(
                    x - other[j, 0] - start * p, y - other[j, 1] - start * q, u - p, s - q,
                    radius + other_radius[j] + MARGIN,
                ),
            )  # fmt: skip
        if not back and v > 0.0:
            for e in range(edges):
                best = min(
                    best,
                    capsule_time(
                        x, y, u, s, radius + MARGIN, v * min(left, best), first[e, 0],
                        first[e, 1], second[e, 0], second[e, 1],
                    ),
                )  # fmt: skip
        if best <= left:
            return start + best
        x, y, angle = x + u * left, y + s * left, angle + w * HELD
    return math.inf
