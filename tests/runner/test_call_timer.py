"""Who watches a worker sees how long its present call lasts, and never sees more."""

import pytest

from benchnav.runner.execute.call_timer import SIZE, CallTimer, calling, write_to


@pytest.fixture
def watch():
    notes = [0.0] * SIZE
    write_to(notes)
    yield CallTimer(notes)
    write_to([0.0] * SIZE)


def test_a_call_lasts_from_look_to_look(watch):
    with calling("act", 0.6):
        watch.look(0.1)
        assert watch.lasted == 0.0  # when it began nobody saw
        watch.look(0.1)
        watch.look(0.25)
        assert watch.lasted == pytest.approx(0.35)
        assert watch.call() == "act at t = 0.6 s"
    watch.look(0.1)
    assert watch.lasted == 0.0


def test_between_calls_and_from_call_to_call_nothing_adds_up(watch):
    for _ in range(50):
        with calling("reset"):
            watch.look(0.9)
        assert watch.lasted == 0.0
    for _ in range(5):
        watch.look(0.9)
        assert watch.lasted == 0.0
    assert watch.call() == "reset"


def test_a_call_that_raises_is_over(watch):
    with pytest.raises(ValueError, match="no"), calling("__init__"):
        raise ValueError("no")
    watch.look(1.0)
    watch.look(1.0)
    assert watch.lasted == 0.0


def test_a_machine_that_slept_makes_no_call_look_long(watch):
    with calling("act", 1.0):
        watch.look(0.1)
        watch.look(8 * 3600.0)
        assert watch.lasted <= 1.0
