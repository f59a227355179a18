"""Compare an episode's rehearsals with those that its navigator was granted and charged."""

from collections.abc import Mapping, Sequence

from benchnav.episode.episode import Episode
from benchnav.runner.rollouts.rehearsal import Rehearsed
from benchnav.runner.rollouts.rollout import Assignment
from benchnav.verify.finding import Report

_SECONDS = 1e-9  # relative; sums of seconds may be rounded


def check_rehearsals(
    assignment: Assignment,
    scored: Episode,
    rehearsals: Sequence[Episode],
    where: str,
    report: Report,
) -> None:
    """Report differences between ``rehearsals``, sorted, and their scored episode."""

    def find(what: str) -> None:
        report.find("rehearsal", where, what)

    granted, done = assignment.rehearsals, Rehearsed(list(rehearsals))
    if scored.rehearsals != granted:
        find(f"{scored.rehearsals} are recorded as granted; the navigator requests {granted}")
    numbers = [e.identity.rehearsal for e in rehearsals]
    if numbers != list(range(1, len(numbers) + 1)):
        find(f"must be numbered from 1; got {numbers}")
    if any(e.rehearsals or e.rehearsal_decisions or e.timings.rehearsal for e in rehearsals):
        find("no rehearsal may itself be granted or charged rehearsals")
    failed = [e for e in rehearsals if e.failure]
    if failed and failed[0] is not rehearsals[-1]:
        find(f"none may follow number {failed[0].identity.rehearsal}, which failed")
    if failed and isinstance(assignment.leader, Mapping):
        name = assignment.leader["type"]
        reason = f"in rehearsal {len(numbers)}, {name!r} that led: {failed[0].failure}"
        if scored.failure != reason:
            find(f"the episode must fail with {reason!r}; got {scored.failure!r}")
    if failed or (granted and not numbers):  # or its process was killed
        if not scored.failure or len(scored.requested):
            find("the episode must have failed before its first decision")
    elif len(numbers) != granted:
        find(f"there must be {granted}; got {len(numbers)}")
    if scored.rehearsal_decisions != done.decisions:
        find(f"{scored.rehearsal_decisions} decisions are charged, not {done.decisions}")
    if abs(scored.timings.rehearsal - done.seconds) > _SECONDS * max(1.0, done.seconds):
        find(f"{scored.timings.rehearsal!r} s are charged, not {done.seconds!r} s")
    if scored.reproducible and not all(e.reproducible for e in rehearsals):
        find("the episode cannot be reproducible if a rehearsal is not")
