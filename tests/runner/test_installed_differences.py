"""How a run differs from the suite of its name that is installed."""

import pytest

from benchnav.runner.plan.installed_differences import caveats_of
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.store.runs.manifest import Manifest


def told(suite):
    return [caveat.text for caveat in caveats_of(Manifest(suite.resolved(), ()))]


@pytest.mark.parametrize("name", ["quick", "standard"])
def test_a_suite_as_it_is_installed_differs_in_nothing(name):
    assert told(load_suite(name, Selection())) == []


def test_other_seeds_and_parameters_of_a_pair_are_told():
    wanted = Selection(navigators=("orca", {"type": "none+dwa", "pause": 9.0}), seeds="3")
    (caveat,) = told(load_suite("standard", wanted))
    assert "seeds 0:3, not 0:100; 2 of its 18 navigators." in caveat
