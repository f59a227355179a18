"""The part of an observation that needs no sensor, and the agents that decide now."""

from benchnav.arrays import AnyArray, BoolArray, FloatArray, IntArray
from benchnav.episode.episode import Status
from benchnav.kernels import kernel_without_allocation

_ACTIVE = int(Status.ACTIVE)


@kernel_without_allocation
def copy_own_state(
    low: int, high: int, chosen: IntArray, agents: AnyArray, limits: AnyArray,
    position: FloatArray, heading: FloatArray, velocity: FloatArray, goal: FloatArray,
    steering: FloatArray,
) -> None:  # fmt: skip
    """Copy the states of the chosen agents of worlds low:high; padding (-1) becomes zero."""
    for b in range(low, high):
        for k in range(chosen.shape[1]):
            a = agents[b, chosen[b, k]]
            if chosen[b, k] >= 0:
                position[b, k, 0], position[b, k, 1] = a.x, a.y
                velocity[b, k, 0], velocity[b, k, 1] = a.vx, a.vy
                goal[b, k, 0], goal[b, k, 1] = a.goal_x, a.goal_y
                heading[b, k], steering[b, k] = a.heading, limits[b, chosen[b, k]].steering
            else:
                position[b, k, 0], position[b, k, 1] = 0.0, 0.0
                velocity[b, k, 0], velocity[b, k, 1] = 0.0, 0.0
                goal[b, k, 0], goal[b, k, 1] = 0.0, 0.0
                heading[b, k], steering[b, k] = 0.0, 0.0


@kernel_without_allocation
def find_deciding(
    low: int, high: int, chosen: IntArray, worlds: AnyArray, agents: AnyArray, active: BoolArray
) -> None:
    """Write which chosen agents of worlds low:high are present and active in a running world."""
    for b in range(low, high):
        running = worlds[b].running
        for k in range(chosen.shape[1]):
            a = agents[b, chosen[b, k]]
            active[b, k] = running and chosen[b, k] >= 0 and a.present and a.status == _ACTIVE
