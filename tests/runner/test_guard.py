"""The guard names what was replaced, puts it back, and minds nothing else."""

import builtins

import numpy as np
import pytest

from benchnav.runner.rollouts import navigator_driver
from benchnav.runner.rollouts.tamper_guard import Guard
from benchnav.world.simulation import Simulation


def other(*_):
    return None


@pytest.mark.parametrize(
    ("owner", "name", "said"),
    [
        (Simulation, "step", "benchnav.world.simulation.Simulation.step"),
        (Simulation, "B", "benchnav.world.simulation.Simulation.B"),
        (navigator_driver, "observe", "benchnav.runner.rollouts.navigator_driver.observe"),
        (np, "zeros_like", "numpy.zeros_like"),
        (builtins, "sorted", "builtins.sorted"),
    ],
)
def test_what_is_replaced_is_named_and_put_back(owner, name, said, monkeypatch):
    honest = vars(owner)[name]
    guard = Guard()
    with monkeypatch.context() as patches:
        patches.setattr(owner, name, other)
        assert guard.replaced() == said
        assert vars(owner)[name] is honest
        assert guard.replaced() == ""


def test_another_body_of_a_function_is_noticed():
    honest, guard = Simulation.fail.__code__, Guard()
    Simulation.fail.__code__ = other.__code__
    assert guard.replaced() == "benchnav.world.simulation.Simulation.fail"
    assert Simulation.fail.__code__ is honest


def test_what_is_added_to_a_class_is_noticed_and_taken_away():
    guard = Guard()
    Simulation.__getattribute__ = other
    assert guard.replaced() == "benchnav.world.simulation.Simulation.__getattribute__"
    assert "__getattribute__" not in vars(Simulation)


def test_what_python_adds_itself_is_nothing():
    guard = Guard()
    Simulation.of_a_test = 3  # as Python keeps annotations, say, that somebody asks for
    try:
        assert guard.replaced() == guard.replaced() == ""
    finally:
        del Simulation.of_a_test
