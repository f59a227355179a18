"""Twists said as planar velocities, for navigators that must answer one kind of command."""

from benchnav.arrays import BoolArray, FloatArray
from benchnav.geometry.rotation import cos_sin
from benchnav.kernels import kernel

MOST = 1.5  # [rad] that a unicycle can be told to turn in a step: it never drives backwards
CREEP = 1e-9  # [m/s] at which to turn on the spot: a velocity of 0 faces nowhere


@kernel
def as_velocity(
    active: BoolArray, unicycle: BoolArray, heading: FloatArray, dt: FloatArray,
    twist: FloatArray, velocity: FloatArray,
) -> None:  # fmt: skip
    """Write the velocities that make bodies turn and drive as twists do.

    A unicycle tracks a velocity u by turning towards it within the step and driving at
    |u| cos(turn) (`benchnav.world.dynamics`), so its twists are executed to rounding; a
    holonomic body drives straight where it faces at the end of the step.

    Args:
        active: (B, A) whose velocities are written.
        unicycle: (B, A) bodies.
        heading: (B, A) [rad].
        dt: (B, A) [s] between decisions.
        twist: (B, A, 2) forward speed [m/s] and turn rate [rad/s].
        velocity: (B, A, 2) [m/s].
    """
    for b in range(active.shape[0]):
        for a in range(active.shape[1]):
            if not active[b, a]:
                continue
            turn = min(max(twist[b, a, 1] * dt[b, a], -MOST), MOST)
            speed = max(twist[b, a, 0], CREEP)
            if unicycle[b, a]:
                speed /= cos_sin(turn)[0]
            c, s = cos_sin(heading[b, a] + turn)
            velocity[b, a, 0], velocity[b, a, 1] = speed * c, speed * s
