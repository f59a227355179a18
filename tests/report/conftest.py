"""A small run with hostile names, and its report."""

import pytest

import benchnav
from benchnav.errors import MissingExtraError
from benchnav.report.shared_files import require_libraries

EVIL = "<img src=x onerror=problems.push(1)>&"  # a label and a title that try to be markup
SUITE = f"""\
name: small
scenarios: [trap/u, ./odd.yaml]
tracks: [known, unknown]
navigators:
  - {{type: orca, label: "{EVIL}"}}
  - straight-line
  - visibility+orca
seeds: 2
"""
ODD = f"""\
name: odd
title: "{EVIL}"
description: "</script><script>problems.push(2)</script>"
bounds: [-6, -6, 6, 6]
static:
  - {{shape: {{type: box, width: 1}}, at: [0, 0]}}
teams:
  - {{name: pair, count: 2, radius: 0.3, max_speed: 1.5,
     start: {{type: region, region: {{type: rectangle, bounds: [-5, -2, -4, 2]}}}},
     goal: {{type: region, region: {{type: rectangle, bounds: [4, -2, 5, 2]}}}}}}
clock: {{dt: 0.2, substeps: 2, horizon: 12}}
"""


@pytest.fixture(scope="session")
def run(tmp_path_factory):
    """Three navigators, one of which needs a map, in two scenarios and two tracks."""
    folder = tmp_path_factory.mktemp("report")
    (folder / "odd.yaml").write_text(ODD)
    (folder / "small.yaml").write_text(SUITE)
    return benchnav.run(folder / "small.yaml", out=folder / "run", quiet=True)


@pytest.fixture(scope="session")
def report(run, tmp_path_factory):
    """The folder of the report."""
    try:
        require_libraries()
    except MissingExtraError as error:
        pytest.skip(str(error))
    return run.report(tmp_path_factory.mktemp("site") / "report", quiet=True).parent
