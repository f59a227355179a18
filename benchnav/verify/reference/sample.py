"""The sample of episodes that the reference simulator replays."""

from collections import defaultdict
from collections.abc import Sequence

from benchnav.verify.part_check import PartCheck


def sampled(checks: Sequence[PartCheck], count: int) -> list[list[int]]:
    """Return for every part the seeds of its episodes in a sample of ``count``.

    Scenarios take turns, and so do the cells of a scenario, each with its next seed: the
    sample is spread and reproducible.
    """
    chosen: list[list[int]] = [[] for _ in checks]
    waiting: dict[str, list[tuple[int, int, int]]] = defaultdict(list)
    for i, check in enumerate(checks):
        for turn, seed in enumerate(check.part.seeds):
            waiting[check.job.scenario.identity].append((turn, i, seed))
    queues = [sorted(queue) for _, queue in sorted(waiting.items())]
    for round_ in range(max(map(len, queues), default=0)):
        for queue in queues:
            if round_ < len(queue) and count > 0:
                _, i, seed = queue[round_]
                chosen[i].append(seed)
                count -= 1
    return chosen
