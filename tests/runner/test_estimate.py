"""The time that is left is told within a factor of two, or not yet: on simulated clocks."""

import re

import numpy as np
import pytest

from benchnav.runner.execute import progress
from benchnav.runner.execute.progress import UNKNOWN, Lines
from benchnav.runner.plan.estimate import Estimate, Load


class Clock:
    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now


def simulated(tasks, workers, startup, seconds):
    """Estimates [s] and truth [s] after every task; the longest effort is begun first.

    ``seconds`` says how long a load takes; the first task of a worker takes ``startup`` longer.
    """
    clock = Clock()
    estimate = Estimate(clock)
    for load in tasks:
        estimate.expect(load)
    queue = sorted(tasks, key=lambda load: -load.effort)
    ends, told = {}, []
    for worker in range(workers):
        load = queue.pop(0)
        estimate.start(worker, load)
        ends[worker] = startup + seconds(load)
    while ends:
        worker = min(ends, key=ends.get)
        clock.now = ends.pop(worker)
        estimate.finish(worker)
        if queue:
            load = queue.pop(0)
            estimate.start(worker, load)
            ends[worker] = clock.now + seconds(load)
        told.append((clock.now, estimate.left()))
    return [(left, clock.now - now) for now, left in told if left is not None]


def within(found, factor=2.0):
    return all(left <= factor * true + 1.0 and true <= factor * left + 1.0 for left, true in found)


@pytest.mark.parametrize("workers", [1, 2, 8])
@pytest.mark.parametrize("startup", [0.0, 60.0])
def test_compiling_and_unequal_tasks_do_not_mislead(workers, startup):
    pace = {"slow": 2e-3, "fast": 5e-5, "planner": 4e-4}
    tasks = [
        Load(name, effort) for name in pace for effort in (1e5, 4e4, 2e4, 8e3, 4e3, 2e3, 1e3)
        for _ in range(4)
    ]  # fmt: skip
    found = simulated(tasks, workers, startup, lambda load: pace[load.navigator] * load.effort)
    assert len(found) > len(tasks) / 2
    assert within(found[:-workers])


def test_noise_is_borne():
    rng = np.random.default_rng(1)
    tasks = [Load(name, effort) for name in "abc" for effort in np.geomspace(1e5, 1e3, 30)]
    found = simulated(tasks, 2, 20.0, lambda load: 1e-4 * load.effort * rng.uniform(0.7, 1.4))
    assert len(found) > 60
    assert within(found[:-2])


def test_nothing_is_told_of_what_was_not_tried():
    clock = Clock()
    estimate = Estimate(clock)
    for load in (Load("a", 10.0), Load("a", 10.0), Load("b", 10.0)):
        estimate.expect(load)
    estimate.start(0, Load("a", 10.0))
    clock.now = 50.0
    estimate.finish(0)
    assert estimate.left() is None  # it also compiled
    estimate.start(0, Load("a", 10.0))
    clock.now = 55.0
    estimate.finish(0)
    assert estimate.left() is None  # b may take any time


def test_a_worker_that_dies_gives_its_task_back():
    clock = Clock()
    estimate = Estimate(clock)
    for _ in range(4):
        estimate.expect(Load("a", 10.0))
    for _ in range(2):
        estimate.start(0, Load("a", 10.0))
        clock.now += 5.0
        estimate.finish(0)
    estimate.start(0, Load("a", 10.0))
    clock.now += 1.0
    assert estimate.left() == pytest.approx(9.0)
    estimate.drop(0)
    assert estimate.left() == pytest.approx(10.0)


def test_lines_tell_the_time_once_it_is_known(capsys):
    clock = Clock()
    lines = Lines(clock=clock)
    lines.begin(40, 0)
    lines.expect([Load("a", 1.0)] * 4)
    for seconds in (100.0, 10.0, 10.0, 10.0):
        lines.start(0, Load("a", 1.0))
        clock.now += seconds
        lines.advance(10)
        lines.finish(0)
    told = capsys.readouterr().err.splitlines()
    assert told[0] == f"10 of 40 episodes, {UNKNOWN}"
    assert re.fullmatch("30 of 40 episodes, about 10 s left", told[2])
    assert told[3] == "40 of 40 episodes"


def test_without_tasks_episodes_are_counted(capsys):
    clock = Clock()
    lines = Lines(clock=clock)
    lines.begin(20, 10)
    clock.now = 10.0
    lines.advance(5)
    assert capsys.readouterr().err == "15 of 20 episodes, about 10 s left\n"


def test_compilation_at_the_first_run_is_told(monkeypatch):
    clock, compiled = [0.0], [0]
    monkeypatch.setattr(progress, "compiled_since", lambda moment: compiled[0])
    shown = Lines(clock=lambda: clock[0])
    shown.begin(40, 0)
    assert shown.left() == UNKNOWN
    clock[0] = 5.0
    assert shown.left() == UNKNOWN
    compiled[0] = 7
    assert shown.left() == "compiling kernels, once per version: 7 so far"
