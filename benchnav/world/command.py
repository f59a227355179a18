"""Commands of the agents that one navigator drives, as commands of all agents of a batch."""

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.kernels import kernel_without_allocation


@kernel_without_allocation
def give_commands(
    low: int, high: int, rows: IntArray, chosen: IntArray, active: BoolArray,
    commands: FloatArray, command: FloatArray,
) -> None:  # fmt: skip
    """Copy commands low:high (N, An, 2) of active agents to ``command`` (B, A, 2).

    Entry n is of the world ``rows[n]``, where the agents are ``chosen[rows[n]]``.
    """
    for n in range(low, high):
        b = rows[n]
        for k in range(active.shape[1]):
            if active[n, k]:
                i = chosen[b, k]
                command[b, i, 0], command[b, i, 1] = commands[n, k, 0], commands[n, k, 1]
