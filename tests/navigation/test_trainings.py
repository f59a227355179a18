"""Several trainings in one spec: their labels, and lists that cannot be used."""

import pytest

from benchnav.errors import ConfigError
from benchnav.navigation.plugin.trainings import (
    Training,
    each_training,
    entries_of,
    entry_of,
    labels_of_entry,
    training_of,
)


def test_each_file_becomes_a_navigator_of_the_entry():
    spec = {"type": "x", "weights": ["a", "b"], "hold": 1}
    assert each_training(spec, "mine", "here") == (
        {"type": "x", "weights": "a", "hold": 1, "label": "mine (training 1 of 2)"},
        {"type": "x", "weights": "b", "hold": 1, "label": "mine (training 2 of 2)"},
    )


def test_the_list_may_be_in_a_part():
    spec = {"type": "p+x", "controller": {"type": "x", "file": ["a", "b", "c"], "k": 2}}
    found = each_training(spec, "p+x", "here")
    assert [each["controller"]["file"] for each in found] == ["a", "b", "c"]
    assert all(each["controller"]["k"] == 2 for each in found)
    assert spec["controller"]["file"] == ["a", "b", "c"]


@pytest.mark.parametrize(
    "spec", ["x", {"type": "x", "weights": "a"}, {"type": "x", "weights": [1, 2]}]
)
def test_other_specs_stay_as_they_are(spec):
    assert each_training(spec, "x", "here") == (spec,)


@pytest.mark.parametrize(
    ("files", "text"),
    [
        (["a"], "here: weights must be one file, or a list of 2 to 99 different files, one for"),
        ([], "Got []."),
        (["a", "a"], "Got ['a', 'a']."),
    ],
)  # fmt: skip
def test_a_list_that_is_none_is_refused(files, text):
    with pytest.raises(ConfigError) as caught:
        each_training({"type": "x", "weights": files}, "x", "here")
    assert text in str(caught.value)


def test_two_lists_are_refused():
    spec = {"type": "x", "weights": ["a", "b"], "leader": {"weights": ["c", "d"]}}
    with pytest.raises(ConfigError, match="Only one parameter can list several trainings"):
        each_training(spec, "x", "here: navigators[0]")


def test_labels_are_read_as_they_are_written():
    training = Training("a (training 1 of 2)", 3, 12)
    assert training_of(training.label) == training
    assert entry_of(training.label) == "a (training 1 of 2)"
    assert [entry_of(name) for name in ("a", "a (training 3 of 2)", "a (training 0 of 2)")] == [
        "a", "a (training 3 of 2)", "a (training 0 of 2)",
    ]  # fmt: skip
    labels = ("b", Training("a", 1, 2).label, Training("a", 2, 2).label)
    assert entries_of(labels) == ("b", "a")
    assert labels_of_entry("a", labels) == labels[1:]
    assert labels_of_entry("b", labels) == ("b",)
