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
SCENARIO = """
name: tiny/open
title: Two discs that change places
bounds: [-3, -3, 3, 3]
teams:
  - name: pair
    count: 2
    radius: 0.2
    max_speed: 1
    start: {type: circle, radius: 2}
    goal: {type: antipodal}
sensing: {neighbours: {count: 4, range: 5}}
clock: {dt: 0.2, substeps: 2, horizon: 10}
"""
SUITE = "name: tiny\nscenarios: [tiny.yaml]\nnavigators: [straight-line]\nseeds: 2\n"


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """A folder that the package is installed into; pip works offline, on a copy."""
    folder = tmp_path_factory.mktemp("outside")
    shutil.copytree(PACKAGE, folder / "source", ignore=shutil.ignore_patterns("__pycache__"))
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "--quiet"]
    offline = ["--no-index", "--no-deps", "--no-build-isolation", "--target"]
    subprocess.run([*pip, *offline, folder / "site", folder / "source"], check=True, timeout=300)
    return folder / "site"


@pytest.fixture
def benchnav(site, tmp_path):
    """Runs the command in a process that finds the installed package; returns its stdout."""

    def call(*arguments):
        environment = {**os.environ, "PYTHONPATH": str(site), "COLUMNS": "200"}
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
    assert project.count("entry-points") == project.count("shy:Shy") == 1


@pytest.mark.slow
def test_it_is_listed_with_where_it_comes_from(benchnav):
    assert "outside-plugin 1.2.3" in benchnav("list", "navigators")
    assert "outside-plugin 1.2.3" in benchnav("show", "shy")


@pytest.mark.slow
def test_it_passes_the_checks_by_name(site):
    program = "from benchnav.testing.check_navigator import check_navigator; check_navigator('shy')"
    environment = {**os.environ, "PYTHONPATH": str(site)}
    subprocess.run([sys.executable, "-c", program], env=environment, check=True, timeout=300)


@pytest.mark.slow
def test_it_takes_part_in_a_run_by_name(benchnav, tmp_path):
    (tmp_path / "tiny.yaml").write_text(SCENARIO)
    (tmp_path / "suite.yaml").write_text(SUITE)
    names = ["--navigator", "straight-line", "--navigator", "{type: shy, fear: 0.3}"]
    benchnav("run", "suite.yaml", "--out", "out", *names, "--workers", "1")
    rows = json.loads(benchnav("leaderboard", "out", "--format", "json"))
    success = {row["navigator"]: row for row in rows if row["metric"] == "success"}
    assert len(success) == 2
    shy = next(row for name, row in success.items() if "shy" in name)
    assert shy["episodes"] == 2
    assert shy["value"] is not None
