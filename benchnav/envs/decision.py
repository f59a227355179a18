"""Kernels of one decision of all agents: actions to commands, and the outcome of a step.

The environments of one world make thousands of decisions a second only if a decision consists of
few calls: with a handful of agents, each call of NumPy takes longer than its work.
"""

import math

from benchnav.arrays import AnyArray, BoolArray, FloatArray, IntArray
from benchnav.episode.episode import Status
from benchnav.kernels import kernel_without_allocation

_ARRIVED, _ENDED = int(Status.ARRIVED), int(Status.ENDED)


@kernel_without_allocation
def scale_actions(
    action: FloatArray, acted: BoolArray, backwards: bool, agents: AnyArray, limits: AnyArray,
    command: FloatArray, away: FloatArray,
) -> None:  # fmt: skip
    """Write the commands of actions, and the distances to the goals before they are executed.

    Args:
        action: (B, A, 2), clipped to [-1, 1].
        acted: (B, A) whose actions count; the commands of others are 0.
        backwards: whether speeds of bodies that can reverse begin at full speed backwards.
        agents: (B, A) records.
        limits: (B, A) records.
        command: (B, A, 2) forward speed [m/s] and turn rate [rad/s].
        away: (B, A) [m].
    """
    for b in range(action.shape[0]):
        for i in range(action.shape[1]):
            body = agents[b, i]
            away[b, i] = math.hypot(body.goal_x - body.x, body.goal_y - body.y)
            if not acted[b, i]:
                command[b, i, 0] = command[b, i, 1] = 0.0
                continue
            speed, turn = _within_one(action[b, i, 0]), _within_one(action[b, i, 1])
            if not (backwards and limits[b, i].reverse):
                speed = 0.5 * (speed + 1.0)
            command[b, i, 0] = speed * body.max_speed
            command[b, i, 1] = turn * body.max_turn_rate


@kernel_without_allocation
def _within_one(x: float) -> float:
    return -1.0 if x < -1.0 else 1.0 if x > 1.0 else x


@kernel_without_allocation
def judge(
    acted: BoolArray, away: FloatArray, executed: FloatArray, worlds: AnyArray, agents: AnyArray,
    arrived: BoolArray, touched: BoolArray, timed_out: BoolArray, active: BoolArray,
    nearer: FloatArray, turned: FloatArray,
) -> None:  # fmt: skip
    """Write the outcome of a step for each agent (B, A).

    Args:
        acted: attempts that were active before it.
        away: [m] to the goals before it.
        executed: (B, A, 2) the executed commands.
        worlds: (B,) records.
        agents: (B, A) records.
        arrived: the attempt ended at the goal.
        touched: the attempt ended in a contact.
        timed_out: the attempt ended at the horizon.
        active: the attempt goes on.
        nearer: decrease of the distance to the goal over that at full speed.
        turned: |turn rate| over its limit.
    """
    for b in range(acted.shape[0]):
        for i in range(acted.shape[1]):
            body, before = agents[b, i], acted[b, i]
            arrived[b, i] = before and body.status == _ARRIVED
            touched[b, i] = before and body.status == _ENDED
            ended = arrived[b, i] or touched[b, i]
            timed_out[b, i] = before and not ended and not worlds[b].running
            active[b, i] = before and not ended and worlds[b].running
            left = math.hypot(body.goal_x - body.x, body.goal_y - body.y)
            nearer[b, i] = (away[b, i] - left) / max(body.max_speed * worlds[b].dt, 1e-9)
            turned[b, i] = abs(executed[b, i, 1]) / max(body.max_turn_rate, 1e-9)


@kernel_without_allocation
def find_driven(mine: IntArray, acting: BoolArray, driven: BoolArray) -> bool:
    """Write which of the agents ``mine`` (B, K; -1: padding) are ``acting`` (B, A).

    Returns whether there is any.
    """
    some = False
    for b in range(mine.shape[0]):
        for k in range(mine.shape[1]):
            driven[b, k] = mine[b, k] >= 0 and acting[b, mine[b, k]]
            some = some or driven[b, k]
    return some


@kernel_without_allocation
def spread(
    mine: IntArray, driven: BoolArray, answer: FloatArray, command: FloatArray, mask: BoolArray
) -> None:
    """Copy the commands ``answer`` (B, K, 2) of driven agents to their places (B, A)."""
    for b in range(mine.shape[0]):
        for k in range(mine.shape[1]):
            if driven[b, k]:
                i = mine[b, k]
                mask[b, i] = True
                command[b, i, 0], command[b, i, 1] = answer[b, k, 0], answer[b, k, 1]
