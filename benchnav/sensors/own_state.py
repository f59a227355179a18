"""The part of an observation that needs no sensor, and the agents that decide now."""

from benchnav.arrays import AnyArray, BoolArray, FloatArray, IntArray
from benchnav.episode.episode import Status
from benchnav.kernels import kernel_without_allocation

_ACTIVE = int(Status.ACTIVE)


@kernel_without_allocation
def copy_own_state(
    low: int, high: int, chosen: IntArray, active: BoolArray, worlds: AnyArray, agents: AnyArray,
    limits: AnyArray, row: IntArray, time: FloatArray, sensing: IntArray, position: FloatArray,
    heading: FloatArray, velocity: FloatArray, goal: FloatArray, steering: FloatArray,
) -> None:  # fmt: skip
    """Copy the states of the chosen agents of worlds low:high; padding (-1) becomes zero.

    Also writes the number of each ``row``, its ``time`` [s], and the agents that are ``sensing``:
    the chosen ones that are ``active``, else -1.
    """
    for b in range(low, high):
        row[b] = b
        time[b] = worlds[b].steps_done * worlds[b].dt
        for k in range(chosen.shape[1]):
            a = agents[b, chosen[b, k]]
            sensing[b, k] = chosen[b, k] if active[b, k] else -1
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
