"""One of n shares of a plan: n runs that can be merged into one. The shares are deterministic."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from heapq import heapify, heapreplace

from benchnav.runner.plan.job import Job
from benchnav.runner.plan.task import chunks

MOST = 10_000
_FORM = re.compile(r"([0-9]{1,5})/([0-9]{1,5})")


@dataclass(frozen=True)
class Shard:
    """The ``index``-th of ``count``, from 1."""

    index: int
    count: int

    @classmethod
    def parse(cls, text: str) -> "Shard":
        """Return the shard of ``"2/4"``. Raises ValueError with the rule and the text."""
        found = _FORM.fullmatch(text)
        shard = cls(int(found[1]), int(found[2])) if found else cls(0, 0)
        if not 1 <= shard.index <= shard.count <= MOST:
            raise ValueError(f"must be i/n, with 1 ≤ i ≤ n ≤ {MOST:,}; got {text[:60]!r}")
        return shard

    def __str__(self) -> str:
        return f"{self.index}/{self.count}"

    def seeds(self, jobs: Iterable[Job], seeds: Sequence[int]) -> dict[str, set[int]]:
        """Return the seeds of this share for each cell, by key.

        Whole tasks are assigned, the longest first, to the share with the least work. Cells of a
        scenario with undisturbed episodes stay together, seed by seed, so that each share has the
        undisturbed episodes that it compares with. Cells that are n/a are left out.
        """
        tasks = [
            (sum(efforts) * (stop - first), keys, first, stop)
            for keys, efforts in _groups(jobs)
            for first, stop in chunks(seeds, max(efforts))
        ]
        tasks.sort(key=lambda task: (-task[0], *task[1:]))
        loads = [(0.0, index) for index in range(1, self.count + 1)]
        heapify(loads)
        mine: dict[str, set[int]] = {}
        for effort, keys, first, stop in tasks:
            load, index = loads[0]
            heapreplace(loads, (load + effort, index))
            for key in keys if index == self.index else ():
                mine.setdefault(key, set()).update(range(first, stop))
        return mine


def _groups(jobs: Iterable[Job]) -> list[tuple[tuple[str, ...], tuple[float, ...]]]:
    """Return keys and efforts of the cells that stay together."""
    every = [job for job in jobs if not job.reason]
    shared = {job.scenario.identity for job in every if job.undisturbed}
    groups = dict[str, list[tuple[str, float]]]()
    for job in every:
        name = job.scenario.identity if job.scenario.identity in shared else job.key
        groups.setdefault(name, []).append((job.key, job.effort))
    return [tuple(zip(*sorted(group), strict=True)) for group in groups.values()]  # type: ignore[misc]
