"""What planners answer is checked, and what a reader must know of it is remarked."""

import numpy as np
import pytest

from benchnav.navigation.command_check import CallFailed
from benchnav.navigation.hierarchy.plan_log import PlanLog, checked_plan
from benchnav.navigation.navigator import PluginConfig
from benchnav.navigation.planner import UNSOLVED, Plan, Planner
from benchnav.navigation.plugin.configure import make
from benchnav.plugins import NAVIGATORS, PLANNERS
from tests.navigation.test_hierarchical import BOUNDS, Map, answers, stand

PATH = np.array([(0.0, 0.0), (1.0, 0.0)])
FOUND = Plan(PATH, True)
NARROW = Plan(PATH, True, clearance=0.01)


def lost(reason="it is late"):
    return Plan(UNSOLVED, False, 0, reason)


def remarks(count, *plans, adapts=True):
    log = PlanLog(count)
    for agent, plan in plans:
        log.note(agent, plan)
    return log.remarks(adapts=adapts)


def test_an_agent_without_a_path_is_remarked():
    assert remarks(1, (0, FOUND)) == []
    assert remarks(1, (0, lost())) == ["the planner found no path: it is late"]
    assert remarks(2, (0, lost()), (1, FOUND)) == [
        "the planner found no path for some agents: it is late"
    ]
    assert remarks(2, (0, lost("a")), (1, lost("b"))) == [
        "the planner found no path for some agents: a",
        "the planner found no path for some agents: b",
    ]


def test_what_changes_later_is_told_apart():
    assert remarks(1, (0, lost()), (0, FOUND)) == ["the planner found no path at first: it is late"]
    assert remarks(1, (0, FOUND), (0, lost())) == [
        "the planner found no new path, and the old one was kept: it is late"
    ]
    assert remarks(1, (0, FOUND), (0, lost()), (0, FOUND)) == []


def test_a_narrow_path_is_remarked_where_its_controller_keeps_a_distance_of_its_own():
    (text,) = remarks(1, (0, NARROW), adapts=False)
    assert "narrower than the planner's clearance" in text
    assert remarks(1, (0, NARROW)) == []


@pytest.mark.parametrize("reason", ["", None, "  "])
def test_a_planner_without_a_reason_is_remarked_too(reason):
    assert remarks(1, (0, lost(reason)))[0].endswith(("gives no reason", "None"))


class Stub(Planner):
    """Answers what it is told to."""

    class Config(PluginConfig):
        pass

    answer = None

    def plan(self, map, start, goal, radius, tolerance, rng):
        if isinstance(self.answer, Exception):
            raise self.answer
        return self.answer


@pytest.fixture
def asked(monkeypatch):
    monkeypatch.setitem(PLANNERS._local, "stub", (Stub, "stub"))

    def ask(answer, map=Map(BOUNDS, ())):  # noqa: B008 - it is frozen
        monkeypatch.setattr(Stub, "answer", answer)
        told, seen = stand(1, [(6.0, 0.0)], map=map)
        navigator = make(NAVIGATORS, "stub+path-following")
        answers(navigator, [told], seen)
        return navigator.remarks(0)

    return ask


@pytest.mark.parametrize(
    ("answer", "text"),
    [
        (None, r"the planner Stub must return a Plan, .*Plan\(UNSOLVED, .*Got None instead"),
        (PATH, "must return a Plan, .* Got a ndarray instead"),
        ([], "must return a Plan, .* Got a list instead"),
        (Plan(UNSOLVED, True), r"must be numbers of shape \(W, 2\), W > 0. Got shape \(0, 2\)"),
        (Plan(np.zeros(4), True), r"Got shape \(4,\)"),
        (Plan(np.zeros((2, 2), complex), True), r"must be numbers"),
        (Plan([(0.0, 0.0)], True), "Got a list"),
        (Plan(np.array([(0.0, np.nan)]), True), "must be finite"),
    ],
)
def test_what_is_no_plan_is_a_failure_with_a_sentence(asked, answer, text):
    with pytest.raises(CallFailed, match=text):
        asked(answer)
    with pytest.raises(CallFailed, match=text):
        checked_plan(answer, Stub())


def test_the_navigator_tells_of_its_row_alone(asked):
    assert asked(lost()) == ["the planner found no path: it is late"]
    assert asked(Plan(PATH, True)) == []
    assert make(NAVIGATORS, "none+path-following").remarks(3) == ()


def test_a_planner_that_raises_raises(asked):
    with pytest.raises(ZeroDivisionError):
        asked(ZeroDivisionError())
