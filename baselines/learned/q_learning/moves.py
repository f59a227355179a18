"""The moves that the table chooses from: every pair of a speed and a turn rate."""

import numpy as np

from benchnav.arrays import FloatArray, IntArray

SPEEDS = (1.0, 0.5, 0.0)  # shares of the preferred speed
TURNS = (0.0, 0.3, -0.3, 1.0, -1.0)  # shares of the largest turn rate in use
MAX_TURN = 2.5  # [rad/s], even if a body could turn faster

MOVES = np.array([(speed, turn) for speed in SPEEDS for turn in TURNS])  # (U, 2)


def twists(move: IntArray, speed: FloatArray, turn_rate: FloatArray) -> FloatArray:
    """Return forward speed [m/s] and turn rate [rad/s] (…, 2) of moves (…), by agents' limits."""
    share = MOVES[move]
    return np.stack([share[..., 0] * speed, share[..., 1] * turn_rate], axis=-1)
