"""Verification in the perception track `noisy`: only running again senses again."""

import pytest

from benchnav.arena.noise import Noise
from benchnav.runner.plan import job
from benchnav.runner.plan.suite import load_suite
from benchnav.runner.run import run_suite

SUITE = """
name: noisy
scenarios: [tiny.yaml]
tracks: [unknown]
perception: [noisy]
navigators: [straight-line, orca]
seeds: 3
"""


@pytest.fixture
def made(scenario, tmp_path):
    """A run of the suite."""
    path = scenario.folder / "noisy.yaml"
    path.write_text(SUITE)

    def made():
        run_suite(load_suite(str(path)), tmp_path / "run", workers=0)
        return tmp_path / "run"

    return made


def test_a_noisy_run_is_simulated_and_sensed_again(made, findings):
    kinds, report = findings(made(), rerun=True)
    assert kinds == set()
    assert report.counts["rerun"] == 6
    assert report.notes == {}


def test_navigators_that_perceived_without_noise_are_found_only_by_running_again(
    made, findings, monkeypatch
):
    with monkeypatch.context() as forged:
        forged.setattr(job, "noise_of", lambda scenario: Noise())
        run = made()
    assert findings(run)[0] == set()
    kinds, report = findings(run, rerun=True)
    assert kinds == {"rerun"}
    assert len({finding.where for finding in report.findings}) == 6
