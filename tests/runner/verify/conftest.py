"""A small run with everything in it: twists, failures, rehearsals, n/a cells."""

import shutil

import pytest

from benchnav.runner.plan.suite import load_suite
from benchnav.runner.run import run_suite
from benchnav.store.packs.unpack import opened
from benchnav.verify.verify import Wanted, verify
from tests.runner.verify.forge import Forger

SUITE = """
name: forged
scenarios: [tiny.yaml]
tracks: [known, stale]
navigators:
  - {type: "troubled_navigators:Walk", label: walk}
  - {type: "troubled_navigators:Rotor", label: rotor}
  - {type: "troubled_navigators:Raises", label: raises}
  - {type: guided-crowd, label: guided, rehearsal: 2, leader: straight-line}
seeds: 3
"""


@pytest.fixture(scope="session")
def genuine(scenario, troubled, tmp_path_factory):
    """The run; nobody changes it."""
    path = scenario.folder / "forged.yaml"
    path.write_text(SUITE)
    run = tmp_path_factory.mktemp("genuine") / "run"
    run_suite(load_suite(str(path)), run, workers=0)
    return run


@pytest.fixture
def forger(genuine, tmp_path):
    """A forger at work on a copy of it."""
    shutil.copytree(genuine, tmp_path / "run")
    return Forger(tmp_path / "run")


@pytest.fixture(scope="session")
def findings():
    """What is found in a run: (kinds, report)."""

    def findings(run, **wanted):
        with opened(run) as folder:
            report = verify(folder, Wanted(**{"twin": 0, **wanted}), workers=0)
        return {finding.kind for finding in report.findings}, report

    return findings
