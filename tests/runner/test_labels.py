"""Navigators that are listed twice get labels from what differs."""

import pytest

from benchnav.runner.plan.contestant import label_of
from benchnav.runner.plan.labels import LONGEST, labelled

ORCA3 = {"type": "orca", "time_horizon": 3}


@pytest.mark.parametrize(
    ("specs", "labels"),
    [
        (["orca", "navmesh"], ["orca", "navmesh"]),
        (["orca", ORCA3], ["orca", "orca(time_horizon=3)"]),
        ([ORCA3], ["orca"]),
        ([ORCA3, {**ORCA3, "range": 2.5}], ["orca", "orca(range=2.5)"]),
        ([{"type": "x", "a": 1}, {"type": "x", "a": 2}], ["x(a=1)", "x(a=2)"]),
        ([{"type": "x", "a": "y"}, {"type": "x", "b": {"c": True}}],
         ["x(a=y)", 'x(b={"c": true})']),
        (["orca", {**ORCA3, "label": "mine"}], ["orca", "mine"]),
        (["orca", {"type": "orca"}], ["orca", "orca"]),
        (["x", {"type": "x", "a": "y" * LONGEST}], ["x", "x#2"]),
    ],
)  # fmt: skip
def test_labels(specs, labels):
    assert [label_of(spec) for spec in labelled(specs)] == labels
    assert [label_of(spec) for spec in labelled(labelled(specs))] == labels
