"""Drivers that a scenario names are checked before anything runs, with file and line."""

import pytest

from benchnav.errors import ScenarioError
from benchnav.navigation.plugin.background_navigators import check_drivers
from benchnav.runner.plan.suite import load_suite
from benchnav.scenario.catalogue import find, names
from benchnav.scenario.load import scenario_from_text
from tests.plain_scenario import PLAIN

SCENARIO = (
    PLAIN
    + """\
  - name: people
    radius: 0.2
    max_speed: 1
    start: {type: points, points: [[-4, 2]]}
    goal: {type: points, points: [[4, 2]]}
    driver: DRIVER
"""
)
SEVERAL = """
      type: orca
      time_horizn: 3
      neighbors: 5"""


@pytest.mark.parametrize(
    ("driver", "complaint"),
    [
        ("orac", "s.yaml:14: teams[1].driver: There is no navigator 'orac'. Did you mean 'orca'?"),
        ("evaluatd", "Did you mean 'evaluated'?"),
        ("grid.astr+orca", "s.yaml:14: teams[1].driver: In the navigator 'grid.astr+orca': There is"
         " no planner 'grid.astr'. Did you mean 'grid.astar'"),
        ("{type: orca, time_horizn: 3}", "s.yaml:14: teams[1].driver.time_horizn: The navigator"
         " 'orca' has no parameter 'time_horizn'. Did you mean 'time_horizon'"),
        ("{type: orca, time_horizon: soon}", "s.yaml:14: teams[1].driver.time_horizon: "),
        (SEVERAL, "s.yaml:16: teams[1].driver.time_horizn: "),
        (SEVERAL, "s.yaml:17: teams[1].driver.neighbors: The navigator 'orca' has no parameter"
         " 'neighbors'. Did you mean 'neighbours'?"),
        ("{type: hierarchical, planner: {type: grid.astar, cel: 2}, controller: orca}",
         "The planner 'grid.astar' has no parameter 'cel'. Did you mean 'cell'?"),
        ("no_such_module:Driver", "no module 'no_such_module' is installed"),
    ],
)  # fmt: skip
def test_a_wrong_driver_is_named(driver, complaint):
    scenario = scenario_from_text(SCENARIO.replace("DRIVER", driver), "s.yaml")
    with pytest.raises(ScenarioError) as caught:
        check_drivers(scenario)
    assert complaint in str(caught.value)


def test_what_ships_has_drivers_that_exist():
    for name in names():
        check_drivers(find(name))


def test_a_suite_is_refused_before_it_runs(tmp_path):
    (tmp_path / "s.yaml").write_text(SCENARIO.replace("DRIVER", "orac"))
    suite = tmp_path / "suite.yaml"
    suite.write_text("name: q\nscenarios: [s.yaml]\nnavigators: [orca]\nseeds: 1\n")
    with pytest.raises(ScenarioError, match=r"s\.yaml:14: teams\[1\]\.driver: .* 'orca'"):
        load_suite(str(suite))
