"""The command, called in this process."""

import shutil

import pytest

from benchnav.cli.main import status

TINY = """
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
clock: {dt: 0.2, substeps: 2, horizon: 6}
"""


@pytest.fixture
def call(capfd):
    """Arguments → (exit status, stdout, stderr)."""

    def call(*arguments):
        code = status([str(argument) for argument in arguments])
        return code, *capfd.readouterr()

    return call


@pytest.fixture
def suite(tmp_path):
    (tmp_path / "open.yaml").write_text(TINY)
    path = tmp_path / "suite.yaml"
    path.write_text(
        "name: tiny\nscenarios: [open.yaml]\nnavigators: [orca, straight-line]\nseeds: 2\n"
        "tracks: [known, unknown]\n"
    )
    return path


@pytest.fixture(scope="session")
def made(tmp_path_factory):
    from benchnav.runner.plan.suite import Selection, load_suite
    from benchnav.runner.run import run_suite

    folder = tmp_path_factory.mktemp("made")
    (folder / "open.yaml").write_text(TINY)
    (folder / "suite.yaml").write_text(
        "name: tiny\nscenarios: [open.yaml]\nnavigators: [straight-line, random-walk]\nseeds: 2\n"
    )
    for label, name in (("one", "straight-line"), ("two", "random-walk")):
        suite = load_suite(str(folder / "suite.yaml"), Selection(navigators=(name,)))
        run_suite(suite, folder / label, workers=1)  # guarded: else nothing is marked
    return folder


@pytest.fixture
def runs(made, tmp_path, monkeypatch):
    """Two runs of a navigator each, on a machine that has verified nothing."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    return [shutil.copytree(made / label, tmp_path / label) for label in ("one", "two")]
