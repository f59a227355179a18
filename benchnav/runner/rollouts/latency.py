"""The cost of a navigator: seconds per call in a single world, and peak memory."""

import sys

from benchnav.arrays import FloatArray
from benchnav.isolation import process_pool
from benchnav.navigation.command_check import CallFailed
from benchnav.navigation.rehearsal import Rehearsal
from benchnav.runner.rollouts.recorder import Recorder
from benchnav.runner.rollouts.rollout import Assignment, Seeded, drive, drivers_of
from benchnav.world.simulation import Simulation

DECISIONS = 50  # of a latency measurement: enough for a percentile, at little cost


def latency(
    assignment: Assignment, seeded: Seeded, rehearsals: tuple[Rehearsal, ...] = ()
) -> FloatArray | None:
    """Return the durations (K ≤ `DECISIONS`,) [s] of the navigator's calls in a single world.

    They come from a separate run with a new navigator, which affects no score. None if the
    navigator fails in this run.
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
    """Return the peak memory [bytes] of this process plus that of its largest child process.

    None if the system cannot measure it.
    """
    try:
        import resource
    except ImportError:  # not on Windows
        return None
    unit = 1 if sys.platform == "darwin" else 1024
    own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit
    ended = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * unit
    return int(own + max(ended, process_pool.peak_memory()))
