import pytest

from benchnav.errors import PluginError, UnknownPluginError
from benchnav.plugins import SCENARIOS
from benchnav.scenario import catalogue
from benchnav.scenario.load import scenario_from_text
from tests.scenario.files import SHIPPED, SMALL


def test_names_are_the_files_that_ship():
    shipped = {f"{path.parent.name}/{path.stem}" for path in SHIPPED}
    assert shipped <= set(catalogue.names())
    assert not any(name.startswith("suites/") for name in catalogue.names())


def test_find_by_name_version_and_path(tmp_path):
    assert catalogue.find("leaders/dynamic").identity == "leaders/dynamic@1"
    assert catalogue.find("leaders/dynamic@1").name == "leaders/dynamic"
    path = tmp_path / "mine.yaml"
    path.write_text(SMALL)
    assert catalogue.find(str(path)).name == "tests/small"


def test_unknown_names():
    with pytest.raises(UnknownPluginError, match=r"Did you mean 'leaders/dynamic'"):
        catalogue.find("leaders/dynamics")
    with pytest.raises(UnknownPluginError, match=r"is at version 1; got 'leaders/dynamic@7'"):
        catalogue.find("leaders/dynamic@7")


def test_plugins(tmp_path):
    scenario = scenario_from_text(SMALL, "s.yaml")
    path = tmp_path / "mine.yaml"
    path.write_text(SMALL)
    SCENARIOS.register("mine/ready")(scenario)
    SCENARIOS.register("mine/path")(path)
    SCENARIOS.register("mine/made")(lambda: scenario)
    SCENARIOS.register("mine/wrong")(3)
    for name in ("mine/ready", "mine/path", "mine/made"):
        assert name in catalogue.names()
        assert catalogue.find(name).hash == scenario.hash
    with pytest.raises(PluginError, match="must be a Scenario, the path of a YAML file"):
        catalogue.find("mine/wrong")
