"""What a machine needs for one world at a time: seconds per call, and memory."""

import sys

from benchnav.arrays import FloatArray
from benchnav.isolation import process_pool
from benchnav.navigation.command_check import CallFailed
from benchnav.navigation.rehearsal import Rehearsal
from benchnav.runner.rollouts.recorder import Recorder
from benchnav.runner.rollouts.rollout import Assignment, Seeded, drive, drivers_of
from benchnav.world.simulation import Simulation

DECISIONS = 50  # of a latency pass: enough for a percentile, few enough to cost nothing


def latency(
    assignment: Assignment, seeded: Seeded, rehearsals: tuple[Rehearsal, ...] = ()
) -> FloatArray | None:
    """(K ≤ `DECISIONS`,) [s] of the navigator's calls when it serves one world alone.

    A pass of its own, with a navigator made for it, and thrown away: nothing that is
    scored knows of it. None where the navigator fails in it.
    """
    simulation = Simulation([seeded[1]])
    recorder = Recorder(simulation)
    try:
        drivers = drivers_of(assignment, simulation, [rehearsals])
        drive(assignment, drivers, recorder, [seeded[0]], DECISIONS)
    except CallFailed:
        return None
    return recorder.seconds


def peak_memory() -> int | None:
    """[bytes] the most that this process ever held in RAM, and the largest navigator's beside it.

    None where the system does not tell.
    """
    try:
        import resource
    except ImportError:  # not on Windows
        return None
    unit = 1 if sys.platform == "darwin" else 1024
    own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit
    ended = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * unit
    return int(own + max(ended, process_pool.peak_memory()))
