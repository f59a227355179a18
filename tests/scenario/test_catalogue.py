import sys

import pytest

from benchnav.config.yaml_packages import missing_packages
from benchnav.errors import PluginConflictError, UnknownPluginError
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


def installed(folder, package, name="outside"):
    """A distribution whose package of scenarios must not be imported."""
    arenas = folder / package / "mine"
    arenas.mkdir(parents=True)
    (folder / package / "__init__.py").write_text("raise RuntimeError('imported')")
    (arenas / "ready.yaml").write_text(SMALL)
    metadata = folder / f"{name}-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (metadata / "entry_points.txt").write_text(f"[benchnav.scenarios]\narenas = {package}\n")


def test_scenarios_of_a_package_are_found_without_importing_it(tmp_path, monkeypatch):
    installed(tmp_path, "outside_arenas_a")
    monkeypatch.syspath_prepend(tmp_path)
    assert "mine/ready" in catalogue.names()
    scenario = scenario_from_text(SMALL, "s.yaml")
    assert catalogue.find("mine/ready").hash == scenario.hash
    assert "outside_arenas_a" not in sys.modules


def test_one_name_in_two_packages_is_a_conflict_that_names_both(tmp_path, monkeypatch):
    for name in ("one", "other"):
        (tmp_path / name).mkdir()
        installed(tmp_path / name, f"outside_arenas_{name}", name)
        monkeypatch.syspath_prepend(tmp_path / name)
    assert "mine/ready" in catalogue.names()
    with pytest.raises(PluginConflictError, match=r"claimed more than once: .*one 1\.0") as caught:
        catalogue.find("mine/ready")
    assert "other 1.0" in str(caught.value)


def test_a_package_that_is_not_there_is_reported(tmp_path, monkeypatch):
    installed(tmp_path, "outside_arenas_b")
    (tmp_path / "outside_arenas_b").rename(tmp_path / "gone")
    monkeypatch.syspath_prepend(tmp_path)
    ((package, cause),) = missing_packages(SCENARIOS)
    assert package == "outside_arenas_b"
    assert "which outside 1.0 names in its entry points (benchnav.scenarios)" in cause
