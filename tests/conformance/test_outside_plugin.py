"""A package of somebody else's: pip-installed for real, checked and run by its name."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parent / "outside_plugin"
MODULE = PACKAGE / "shy.py"


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """A folder that the package is installed into; pip works offline, on a copy."""
    folder = tmp_path_factory.mktemp("outside")
    shutil.copytree(PACKAGE, folder / "source", ignore=shutil.ignore_patterns("__pycache__"))
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "--quiet"]
    offline = ["--no-index", "--no-deps", "--no-build-isolation", "--target"]
    subprocess.run([*pip, *offline, folder / "site", folder / "source"], check=True, timeout=300)
    return folder / "site"


def search_path(site):
    inherited = os.environ.get("PYTHONPATH", "")
    return os.pathsep.join([str(site), *([inherited] if inherited else [])])


@pytest.fixture
def benchnav(site, tmp_path):
    """Runs the command in a process that finds the installed package; returns its stdout."""

    def call(*arguments):
        environment = {**os.environ, "PYTHONPATH": search_path(site), "COLUMNS": "200"}
        command = [Path(sys.executable).with_name("benchnav"), *map(str, arguments)]
        done = subprocess.run(
            command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300,
            check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        return done.stdout

    return call


def test_a_complete_plugin_is_at_most_fifteen_lines_and_one_entry_point():
    lines = [line for line in MODULE.read_text().splitlines() if line.strip()]
    assert len(lines) <= 15
    project = (PACKAGE / "pyproject.toml").read_text()
    assert project.count("shy:Shy") == 1


@pytest.mark.slow
def test_it_is_listed_with_where_it_comes_from(benchnav):
    assert "outside-plugin 1.2.3" in benchnav("list", "navigators")
    assert "outside-plugin 1.2.3" in benchnav("show", "shy")


@pytest.mark.slow
def test_it_passes_the_checks_by_name(site):
    program = "from benchnav.testing.check_navigator import check_navigator; check_navigator('shy')"
    environment = {**os.environ, "PYTHONPATH": search_path(site)}
    subprocess.run([sys.executable, "-c", program], env=environment, check=True, timeout=300)


@pytest.mark.slow
def test_its_scenarios_and_suites_are_listed_and_shown_without_importing_it(benchnav):
    assert "tiny/open" in benchnav("list", "scenarios")
    assert "version 1, outside-plugin 1.2.3  Two discs" in benchnav("list", "scenarios")
    assert "version 1, outside-plugin 1.2.3  A suite of another" in benchnav("list", "suites")
    assert "Two discs that change places" in benchnav("show", "tiny/open")
    assert "tiny/open@1" in benchnav("show", "tiny")


@pytest.mark.slow
def test_its_robot_is_listed_and_shown_without_importing_it(benchnav):
    assert "outside-plugin 1.2.3  A cart of another package" in benchnav("list", "robots")
    assert "radius: 0.4" in benchnav("show", "cart")


@pytest.mark.slow
def test_its_trainer_and_recipe_are_used_and_a_broken_trainer_is_listed(benchnav, tmp_path):
    trainers = benchnav("list", "trainers").splitlines()
    assert any(line.startswith("teacher") and "Writes its seed" in line for line in trainers)
    assert any(line.startswith("broken") and "must not import" in line for line in trainers)
    recipes = benchnav("list", "recipes")
    assert "A first lesson" in recipes
    assert "(of broken)" in recipes
    assert "a recipe of the trainer teacher: A first lesson" in benchnav("show", "lesson")
    benchnav("train", "lesson", "--seed", "7", "--out", "learned")
    assert (tmp_path / "learned" / "weights.safetensors").read_text() == "lesson 7"


@pytest.mark.slow
def test_it_takes_part_in_a_run_by_name_of_its_own_suite_and_scenario(benchnav):
    names = ["--navigator", "straight-line", "--navigator", "{type: shy, fear: 0.3}"]
    benchnav("run", "tiny", "--out", "out", *names, "--workers", "1")
    rows = json.loads(benchnav("leaderboard", "out", "--format", "json"))
    success = {row["navigator"]: row for row in rows if row["metric"] == "success"}
    assert len(success) == 2
    shy = next(row for name, row in success.items() if "shy" in name)
    assert shy["episodes"] == 2
    assert shy["value"] is not None
