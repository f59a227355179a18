import pytest

from benchnav.errors import ConfigError, PluginError, UnknownPluginError
from benchnav.navigation.configure import configure, make, split
from benchnav.navigation.hierarchical import Hierarchical
from benchnav.navigation.navigator import Need
from benchnav.plugins import CONTROLLERS, NAVIGATORS
from benchnav.runner.suite import Selection, load_suite


def test_a_pair_is_a_hierarchical_navigator_of_its_parts():
    assert split(NAVIGATORS, "ompl.prm+orca") == (
        "hierarchical",
        {"planner": "ompl.prm", "controller": "orca"},
    )
    navigator = make(NAVIGATORS, "ompl.prm+orca")
    assert type(navigator) is Hierarchical
    assert type(navigator.planner).__name__ == "PRM"
    assert navigator.required == {Need.MAP, Need.NEIGHBOURS, Need.EDGES}


def test_parameters_of_the_pair_and_of_its_parts_stand_beside_the_name():
    spec = {
        "type": "mapping+ompl.rrt-connect+orca",
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
    assert navigator.required == {Need.RAYS, Need.NEIGHBOURS, Need.EDGES}


def test_parts_may_be_named_by_module():
    name = "benchnav_baselines.ompl.planners:PRM+benchnav_baselines.path_following:PathFollowing"
    assert type(make(NAVIGATORS, name).controller).__name__ == "PathFollowing"


def test_a_plus_in_the_name_of_another_kind_means_nothing():
    with pytest.raises(UnknownPluginError, match=r"no controller 'ompl.prm\+orca'"):
        make(CONTROLLERS, "ompl.prm+orca")


def test_a_registered_name_is_that_navigator(monkeypatch):
    monkeypatch.setitem(NAVIGATORS._local, "ompl.prm+orca", (Hierarchical, "here"))
    assert split(NAVIGATORS, "ompl.prm+orca") == ("ompl.prm+orca", {})


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        (
            "ompl.prm+orcaa",
            "f.yaml:3: In the navigator 'ompl.prm+orcaa': There is no controller 'orcaa'."
            " Did you mean 'orca'? 'benchnav list controllers' shows all.",
        ),
        (
            "ompl.pmr+orca",
            "f.yaml:3: In the navigator 'ompl.pmr+orca': There is no planner 'ompl.pmr'."
            " Did you mean 'ompl.prm'? 'benchnav list planners' shows all.",
        ),
        (
            "maping+ompl.prm+orca",
            "f.yaml:3: A navigator named by its parts must be PLANNER+CONTROLLER, none+CONTROLLER"
            " or mapping+PLANNER+CONTROLLER. Got 'maping+ompl.prm+orca' instead."
            " Did you mean 'mapping'?",
        ),
        (
            "ompl.prm+",
            "f.yaml:3: A navigator named by its parts must be PLANNER+CONTROLLER, none+CONTROLLER"
            " or mapping+PLANNER+CONTROLLER. Got 'ompl.prm+' instead.",
        ),
        (
            {"type": "ompl.prm+orca", "controller": "path-following"},
            "f.yaml:3: The navigator 'ompl.prm+orca' names its controller: the parameter"
            " 'controller' must be a mapping of that controller's parameters. Got"
            " 'path-following' instead.",
        ),
        (
            {"type": "ompl.prm+orca", "cutt": 1},
            "f.yaml:3: The navigator 'ompl.prm+orca' has no parameter 'cutt'. Did you mean 'cut'?",
        ),
        (
            {"type": "ompl.prm+orca", "controller": {"margn": 1}},
            "f.yaml:3: controller: The controller 'orca' has no parameter 'margn'."
            " Did you mean 'margin'?",
        ),
    ],
)
def test_what_is_refused_and_how(spec, message):
    with pytest.raises(PluginError) as caught:
        configure(NAVIGATORS, spec, where="f.yaml:3")
    assert str(caught.value) == message


def test_a_map_for_no_planner_is_refused():
    with pytest.raises(ConfigError, match="must be given a planner where it maps"):
        make(NAVIGATORS, "mapping+none+orca")


def test_the_name_of_a_part_alone_says_how_it_becomes_a_navigator():
    with pytest.raises(UnknownPluginError, match=r"a planner: ompl.prm\+CONTROLLER is a navigator"):
        make(NAVIGATORS, "ompl.prm")
    with pytest.raises(UnknownPluginError, match=r"none\+path-following are navigators"):
        make(NAVIGATORS, "path-following")


def test_a_suite_takes_pairs_and_counts_their_parts():
    long = "{type: hierarchical, planner: ompl.prm, controller: orca, label: long}"
    other = "{type: ompl.prm+orca, label: other, controller: {margin: 0.2}}"
    names = ("ompl.prm+orca", long, other, "none+recurrent-ppo", "recurrent-ppo")
    suite = load_suite("quick", Selection(scenarios=("trap/u",), navigators=names))
    pair, same, different, alone, learned = suite.entries
    assert pair.label == "ompl.prm+orca"
    assert pair.hash == same.hash != different.hash
    assert pair.spec["controller"]["margin"] == 0.05
    assert alone.fingerprint == learned.fingerprint
    assert alone.training == learned.training


def test_the_distribution_of_a_part_counts(monkeypatch):
    selected = Selection(scenarios=("trap/u",), navigators=("ompl.prm+mine",))
    controller = CONTROLLERS.load("orca")
    monkeypatch.setitem(CONTROLLERS._local, "mine", (controller, "here"))
    (entry,) = load_suite("quick", selected).entries
    assert entry.source == "benchnav 0.1.0, registered in this process"


def test_a_pair_without_its_map_is_not_applicable():
    names = ("ompl.prm+orca", "mapping+ompl.prm+orca", "none+orca")
    wanted = Selection(scenarios=("trap/u",), tracks=("unknown",), navigators=names)
    reasons = [cell.reason for cell in load_suite("quick", wanted).cells()]
    assert reasons == ["needs a map", "", ""]
