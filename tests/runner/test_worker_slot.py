"""The order of tasks, and the code that may share a process."""

from types import SimpleNamespace

import pytest

from benchnav.runner.execute.executor import WorkerPool
from benchnav.runner.execute.progress import Progress
from benchnav.runner.execute.worker_slot import WorkerSlot
from benchnav.runner.plan.limits import Limits


def task(navigator, drivers=""):
    return SimpleNamespace(process_key=(navigator, drivers))


def slot_after(navigator, drivers=""):
    slot = WorkerSlot(Limits(), ())
    slot.process_key = (navigator, drivers)
    return slot


@pytest.mark.parametrize(
    ("before", "after", "shared"),
    [
        (("a", ""), ("a", ""), True),
        (("a", ""), ("a", "d"), True),
        (("a", "d"), ("a", "d"), True),
        (("a", "d"), ("a", ""), False),
        (("a", "d"), ("a", "e"), False),
        (("a", ""), ("b", ""), False),
        (("", ""), ("a", ""), False),
    ],
)
def test_a_process_runs_no_code_of_others_before_a_task(before, after, shared):
    assert slot_after(*before).may_run(task(*after)) is shared


def test_a_slot_keeps_its_process_and_takes_drivers_last():
    pool = WorkerPool(2, Progress(), Limits())
    busy, free = slot_after("b"), slot_after("a")
    busy.task = task("b")
    pool.slots = [busy, free]
    pool.pending.extend(task(*key) for key in [("b", ""), ("c", "d"), ("a", "d"), ("c", "")])
    pool.pending.append(task("a"))
    taken = []
    while pool.pending:
        chosen = pool._next_task(free)
        free.process_key = chosen.process_key
        taken.append(chosen.process_key)
    assert taken == [("a", ""), ("a", "d"), ("c", ""), ("c", "d"), ("b", "")]
