"""The last lines of a run count worlds as the leaderboard does."""

from benchnav.runner.conclusion import conclusion
from benchnav.runner.run import Summary

TOLD = [
    ("prm", "a/one@1", "no path was found within 1 s at t = 0.4 s"),
    ("prm", "a/one@1", "no path was found within 2 s at t = 3 s"),
    ("prm", "b/two@1", "no path was found within 1 s"),
]


def remarks(*told):
    summary = Summary()
    summary.remarks.update(told)
    return [line for line in conclusion(summary, 1.0).splitlines() if line.startswith("remark")]


def test_remarks_of_one_kind_are_one_line():
    (line,) = remarks(*TOLD)
    assert line == "remark: prm in 3 worlds of 2 scenarios: no path was found within 1 s"


def test_one_scenario_is_named():
    (line,) = remarks(*TOLD[:1])
    assert line == "remark: prm in 1 world of a/one@1: no path was found within 1 s"
