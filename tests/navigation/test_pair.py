"""Navigators named by their parts."""

import pytest

from benchnav.errors import ConfigError, PluginError, UnknownPluginError
from benchnav.navigation.hierarchy.hierarchical import Hierarchical
from benchnav.navigation.navigator import Need
from benchnav.navigation.plugin.configure import configure, make, split
from benchnav.plugins import CONTROLLERS, NAVIGATORS
from benchnav.runner.plan.suite import Selection, load_suite

FORM = (
    "A navigator named by its parts must be PLANNER+CONTROLLER, none+CONTROLLER or"
    " mapping+PLANNER+CONTROLLER."
)


def test_a_pair_is_hierarchical_with_these_parts():
    parts = {"planner": "grid.astar", "controller": "orca"}
    assert split(NAVIGATORS, "grid.astar+orca") == ("hierarchical", parts)
    navigator = make(NAVIGATORS, "grid.astar+orca")
    assert type(navigator) is Hierarchical
    assert navigator.config.planner["type"] == "grid.astar"
    assert navigator.config.controller["type"] == "orca"
    assert navigator.mapping is None
    assert navigator.required == {Need.MAP, Need.NEIGHBOURS, Need.EDGES}
    assert [part.name for part in navigator.parts] == ["grid.astar", "orca"]


def test_parameters_of_the_pair_and_of_its_parts_stand_beside_the_name():
    spec = {
        "type": "mapping+grid.astar+orca",
        "replan": ["blocked", {"every": 2}],
        "mapping": {"share": True},
        "planner": {"clearance": 0.1},
        "controller": {"margin": 0.2},
    }
    navigator = make(NAVIGATORS, spec)
    assert navigator.config.replan[1].every == 2.0
    assert navigator.mapping.config.share
    assert navigator.planner.config.clearance == 0.1
    assert navigator.controller.config.margin == 0.2


def test_without_a_planner_or_with_mapping_no_map_is_needed():
    names = ("grid.astar+orca", "mapping+grid.astar+orca", "none+orca")
    wanted = Selection(scenarios=("trap/u",), tracks=("unknown",), navigators=names)
    reasons = [job.reason for job in load_suite("quick", wanted).jobs()]
    assert reasons == ["needs a map", "", ""]


def test_parts_may_be_named_by_module():
    name = (
        "benchnav_baselines.planners.ompl.planners:PRM"
        "+benchnav_baselines.controllers.path_following:PathFollowing"
    )
    assert type(make(NAVIGATORS, name).controller).__name__ == "PathFollowing"


def test_a_plus_in_the_name_of_another_kind_means_nothing():
    with pytest.raises(UnknownPluginError, match=r"no controller 'grid.astar\+orca'"):
        make(CONTROLLERS, "grid.astar+orca")


def test_a_registered_name_is_that_navigator(monkeypatch):
    monkeypatch.setitem(NAVIGATORS._local, "grid.astar+orca", (Hierarchical, "here"))
    assert split(NAVIGATORS, "grid.astar+orca") == ("grid.astar+orca", {})


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        (
            "grid.astar+orcaa",
            "In the navigator 'grid.astar+orcaa': There is no controller 'orcaa'."
            " Did you mean 'orca' or 'orca-ppo'? 'benchnav list controllers' shows all.",
        ),
        (
            "navmehs+orca",
            "In the navigator 'navmehs+orca': There is no planner 'navmehs'."
            " Did you mean 'navmesh'? 'benchnav list planners' shows all.",
        ),
        (
            "maping+grid.astar+orca",
            f"{FORM} Got 'maping+grid.astar+orca' instead. Did you mean 'mapping'?",
        ),
        ("grid.astar+", f"{FORM} Got 'grid.astar+' instead."),
        ("a+b+c+d", f"{FORM} Got 'a+b+c+d' instead."),
        (
            {"type": "grid.astar+orca", "controller": "path-following"},
            "The navigator 'grid.astar+orca' names its controller: the parameter 'controller' must"
            " be a mapping of that controller's parameters. Got 'path-following' instead.",
        ),
        (
            {"type": "grid.astar+orca", "cutt": 1},
            "The navigator 'grid.astar+orca' has no parameter 'cutt'. Did you mean 'cut'?",
        ),
        (
            {"type": "grid.astar+orca", "controller": {"neighbors": 1}},
            "controller: The controller 'orca' has no parameter 'neighbors'."
            " Did you mean 'neighbours'?",
        ),
    ],
)
def test_what_is_refused_and_how(spec, message):
    with pytest.raises(PluginError) as caught:
        configure(NAVIGATORS, spec, where="f.yaml:3")
    assert str(caught.value) == f"f.yaml:3: {message}"


def test_a_map_for_no_planner_is_refused():
    with pytest.raises(ConfigError, match="must be given a planner if mapping is on"):
        make(NAVIGATORS, "mapping+none+orca")


def test_the_name_of_a_part_alone_says_how_it_becomes_a_navigator():
    with pytest.raises(UnknownPluginError, match=r"planner: grid.astar\+CONTROLLER is a navigator"):
        make(NAVIGATORS, "grid.astar")
    with pytest.raises(UnknownPluginError, match=r"none\+path-following are navigators"):
        make(NAVIGATORS, "path-following")


def test_a_suite_takes_pairs_and_counts_their_parts():
    long = "{type: hierarchical, planner: grid.astar, controller: orca, label: long}"
    other = "{type: grid.astar+orca, label: other, controller: {margin: 0.2}}"
    names = ("grid.astar+orca", long, other, "none+recurrent-ppo", "recurrent-ppo")
    suite = load_suite("quick", Selection(scenarios=("trap/u",), navigators=names))
    pair, same, different, alone, learned = suite.contestants
    assert pair.label == "grid.astar+orca"
    assert pair.hash == same.hash != different.hash
    assert pair.spec["controller"]["margin"] == 0.05
    assert alone.fingerprint == learned.fingerprint
    assert alone.training == learned.training


def test_the_distribution_of_a_part_counts(monkeypatch):
    selected = Selection(scenarios=("trap/u",), navigators=("grid.astar+mine",))
    monkeypatch.setitem(CONTROLLERS._local, "mine", (CONTROLLERS.load("orca"), "here"))
    (contestant,) = load_suite("quick", selected).contestants
    assert contestant.source.endswith(", registered in this process")
    assert contestant.source.startswith("benchnav ")
