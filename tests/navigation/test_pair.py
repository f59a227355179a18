"""Navigators named by their parts."""

import pytest

from benchnav.errors import ConfigError, UnknownPluginError
from benchnav.navigation.configure import configure, make
from benchnav.navigation.navigator import Need
from benchnav.navigation.pair import is_pair, parameters_of
from benchnav.plugins import NAVIGATORS


def test_a_pair_is_hierarchical_with_these_parts():
    navigator = make(NAVIGATORS, "grid.astar+orca")
    assert navigator.config.planner["type"] == "grid.astar"
    assert navigator.config.controller["type"] == "orca"
    assert navigator.mapping is None
    assert Need.MAP in navigator.required
    assert [part.name for part in navigator.parts] == ["grid.astar", "orca"]


def test_parameters_of_a_part_stand_under_its_kind():
    spec = {"type": "grid.astar+orca", "replan": "never", "controller": {"margin": 0.1}}
    _, config = configure(NAVIGATORS, spec)
    assert config.controller["margin"] == 0.1
    assert config.replan == "never"


def test_without_a_planner_or_with_mapping_no_map_is_needed():
    assert Need.MAP not in make(NAVIGATORS, "none+orca").required
    mapped = make(NAVIGATORS, "mapping+grid.astar+orca")
    assert mapped.mapping is not None
    assert Need.MAP not in mapped.required


@pytest.mark.parametrize(
    ("name", "error", "says"),
    [
        ("grid.astra+orca", UnknownPluginError, "In the navigator .*Did you mean 'grid.astar'"),
        ("grid.astar+orka", UnknownPluginError, "Did you mean 'orca'"),
        ("maping+grid.astar+orca", ConfigError, "mapping.PLANNER.CONTROLLER. Got .*'mapping'"),
        ("grid.astar+", ConfigError, "must be PLANNER"),
        ("a+b+c+d", ConfigError, "must be PLANNER"),
    ],
)
def test_wrong_names_are_refused(name, error, says):
    assert is_pair(name)
    with pytest.raises(error, match=says):
        make(NAVIGATORS, name)


def test_a_part_cannot_be_named_twice():
    with pytest.raises(ConfigError, match="must be a mapping of that planner's parameters"):
        parameters_of("grid.astar+orca", {"planner": "visibility"})
