"""States as their difference from a prediction: agents mostly move as their commands say.

The executed commands, positions and headings of an episode follow from its world, the requested
commands and each other, except where bodies touch, arrive or end; obstacles follow their laws
of motion. Stored are the bits of the
state, exclusive or those of the prediction: nearly all are zero, and take no space when they are
compressed. Decoding predicts again, in the order of time, and returns the same bits.

The prediction uses the formulas of `benchnav.world`, whose bits are pinned by tests. They are a
part of the file format: a change of them needs a copy of the old ones here.
"""

from typing import Any

import numpy as np

from benchnav.arena.agents import Dynamics
from benchnav.arena.body import LawKind
from benchnav.arena.world import World
from benchnav.arrays import AnyArray, BoolArray, ByteArray, FloatArray, IntArray
from benchnav.episode.episode import Status
from benchnav.geometry.rotation import angle_of, wrap
from benchnav.kernels import kernel_without_allocation
from benchnav.world.bodies import body_at, law_records
from benchnav.world.dynamics import limited, planar_velocity
from benchnav.world.motion_limits import limit_records, within_limits

CODED = ("executed", "position", "heading")
BODIES = "body_position"
MAX_SUBSTEPS = 100  # of a scenario; a world with more is stored as it is
_ACTIVE = int(Status.ACTIVE)
_RELOCATE = int(LawKind.RELOCATE)
_HOLONOMIC = int(Dynamics.HOLONOMIC)


def can_code(world: World) -> bool:
    """Whether the states of this world's episodes can be stored as differences."""
    return 1 <= world.clock.substeps <= MAX_SUBSTEPS


def coded(world: World, twist: BoolArray, states: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """Return the arrays of `CODED` and `BODIES` as differences; the inverse of `decoded`.

    Args:
        world: of the episode.
        twist: (A,) whose commands are twists.
        states: ``requested`` (T, A, 2), ``status`` (T+1, A), and those to code.
    """
    return _convert(world, twist, states, decode=False)


def decoded(world: World, twist: BoolArray, states: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """Return the arrays of `CODED` and `BODIES` from their differences.

    Raises ValueError if `can_code` is false, or an array of the world has a wrong shape.
    """
    if not can_code(world):
        raise ValueError(
            f"coded states need 1 to {MAX_SUBSTEPS} substeps; got {world.clock.substeps}"
        )
    for law in (body.law for body in world.bodies):
        if law.points.ndim != 2 or law.points.shape[1] != 2 or not len(law.points):
            raise ValueError("a law of motion must have points (N, 2)")
    return _convert(world, twist, states, decode=True)


def _convert(
    world: World, twist: BoolArray, states: dict[str, FloatArray], decode: bool
) -> dict[str, FloatArray]:
    given = [np.ascontiguousarray(states[name], np.float64) for name in CODED]
    result = [np.empty_like(array) for array in given]
    true = result if decode else given  # where the predictions read
    clock, size = world.clock, len(world.agents)

    def column(name: str, *shape: int) -> FloatArray:  # kernels do not notice a wrong shape
        values = np.ascontiguousarray(getattr(world.agents, name), np.float64)
        return values.reshape(size, *shape)

    arrays: list[Any] = [*true, *result]
    arrays += [array.view(np.int64) for array in (*result, *given)]
    _code(
        np.ascontiguousarray(states["requested"], np.float64),
        np.ascontiguousarray(states["status"], np.int8),
        np.ascontiguousarray(twist, np.bool_).reshape(size), column("dynamics") != _HOLONOMIC,
        column("max_speed"), column("max_turn_rate"), world.agents.limited,
        limit_records(world.agents), column("start", 2), column("heading"),
        float(clock.dt), clock.substeps, *arrays,
    )  # fmt: skip
    return {**dict(zip(CODED, result, strict=True)), BODIES: _bodies(world, states[BODIES], decode)}


def _bodies(world: World, given: FloatArray, decode: bool) -> FloatArray:
    given = np.ascontiguousarray(given, np.float64)
    if not given.size:
        return given
    rows, knots = law_records(world.bodies)
    result, h = np.empty_like(given), world.clock.dt / world.clock.substeps
    _code_bodies(
        rows, knots, h, world.clock.substeps, result if decode else given, result,
        result.view(np.int64), given.view(np.int64),
    )  # fmt: skip
    return result


@kernel_without_allocation
def _code(
    requested: FloatArray, status: ByteArray, twist: BoolArray, nonholonomic: BoolArray,
    max_speed: FloatArray, max_turn_rate: FloatArray, has_limits: bool, limits: AnyArray,
    start: FloatArray, facing: FloatArray, dt: float, substeps: int,
    executed: FloatArray, position: FloatArray, heading: FloatArray,
    new_executed: FloatArray, new_position: FloatArray, new_heading: FloatArray,
    executed_bits: IntArray, position_bits: IntArray, heading_bits: IntArray,
    given_executed: IntArray, given_position: IntArray, given_heading: IntArray,
) -> None:  # fmt: skip
    """Write predictions to the ``new`` arrays, then combine their bits with the given ones.

    ``executed``, ``position`` and ``heading`` are the true states, complete up to the predicted.
    """
    h = dt / substeps
    for i in range(len(twist)):
        turning = nonholonomic[i] or twist[i]
        new_position[0, i, 0], new_position[0, i, 1] = start[i, 0], start[i, 1]
        new_heading[0, i] = facing[i]
        previous_0, previous_1 = 0.0, 0.0  # the executed command
        position_bits[0, i, 0] ^= given_position[0, i, 0]
        position_bits[0, i, 1] ^= given_position[0, i, 1]
        heading_bits[0, i] ^= given_heading[0, i]
        for t in range(len(requested)):
            drive_0, drive_1 = 0.0, 0.0
            if status[t, i] == _ACTIVE and has_limits:
                drive_0, drive_1 = within_limits(
                    requested[t, i, 0], requested[t, i, 1], twist[i], heading[t, i], previous_0,
                    previous_1, limits[i], dt,
                )  # fmt: skip
            elif status[t, i] == _ACTIVE:
                drive_0, drive_1 = limited(
                    requested[t, i, 0], requested[t, i, 1], twist[i], nonholonomic[i],
                    heading[t, i], max_speed[i], max_turn_rate[i], dt,
                )  # fmt: skip
            new_executed[t, i, 0], new_executed[t, i, 1] = drive_0, drive_1
            executed_bits[t, i, 0] ^= given_executed[t, i, 0]
            executed_bits[t, i, 1] ^= given_executed[t, i, 1]
            drive_0, drive_1 = executed[t, i, 0], executed[t, i, 1]
            previous_0, previous_1 = drive_0, drive_1
            x, y, angle = position[t, i, 0], position[t, i, 1], heading[t, i]
            if status[t, i] == _ACTIVE:
                for _ in range(substeps):
                    vx, vy = planar_velocity(drive_0, drive_1, turning, angle, h)
                    x += vx * h
                    y += vy * h
                    if turning:
                        angle = wrap(angle + drive_1 * h)
                if not turning and (drive_0 != 0.0 or drive_1 != 0.0):
                    angle = wrap(angle_of(drive_0, drive_1))
            new_position[t + 1, i, 0], new_position[t + 1, i, 1] = x, y
            new_heading[t + 1, i] = angle
            position_bits[t + 1, i, 0] ^= given_position[t + 1, i, 0]
            position_bits[t + 1, i, 1] ^= given_position[t + 1, i, 1]
            heading_bits[t + 1, i] ^= given_heading[t + 1, i]


@kernel_without_allocation
def _code_bodies(
    bodies: AnyArray, knots: AnyArray, h: float, substeps: int, position: FloatArray,
    new: FloatArray, bits: IntArray, given: IntArray,
) -> None:  # fmt: skip
    """Do the same with the positions of obstacles; a relocated one stays until it is moved."""
    for t in range(len(new)):
        for m in range(len(bodies)):
            if bodies[m].law == _RELOCATE and t > 0:
                new[t, m, 0], new[t, m, 1] = position[t - 1, m, 0], position[t - 1, m, 1]
            else:
                new[t, m, 0], new[t, m, 1] = body_at(bodies[m], knots, (t * substeps) * h)
            bits[t, m, 0] ^= given[t, m, 0]
            bits[t, m, 1] ^= given[t, m, 1]
