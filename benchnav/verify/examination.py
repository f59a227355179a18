"""All requested checks of one part."""

from dataclasses import dataclass

from benchnav.verify.finding import Report
from benchnav.verify.part_check import PartCheck, check_part
from benchnav.verify.reference.fcl_check import judge
from benchnav.verify.reference.reference_check import check_twin


@dataclass(frozen=True)
class Examination:
    """A part, and the checks to make."""

    check: PartCheck
    twin: tuple[int, ...]  # seeds of the episodes that the reference simulator replays
    twin_seconds: float  # [s] of processor time for each of them
    referee: bool


def examine(task: Examination) -> Report:
    """Re-simulate the part, and make the other requested checks."""
    report, scored, rehearsed = check_part(task.check)
    for pair in scored + rehearsed:
        if pair.stored.identity.seed in task.twin:
            check_twin(pair.again.world, pair.again, pair.where, report, task.twin_seconds)
    if task.referee:
        for pair in scored + rehearsed:
            judge(pair, report)
    return report
