"""The command, called in this process."""

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
