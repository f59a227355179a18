"""The family `people`: what its worlds hold, and that navigators run in it and verify."""

import numpy as np
import pytest

import benchnav
from benchnav.generation.build import build
from benchnav.scenario.catalogue import find

FAMILY = ("people/corridor", "people/crossing", "people/station-hall")
STREAMS = {"people/corridor": 2, "people/crossing": 2, "people/station-hall": 4}
NAVIGATORS = (
    "straight-line", "orca", "none+social-groups", "visibility+path-following", "visibility+dwa",
)  # fmt: skip


def crowd(name, people, unaware=0.2):
    """The world of test seed 0 with so many people."""
    each = people // STREAMS[name]
    blind = round(unaware * each)
    return build(find(f"{name}:reactive={each - blind},unaware={blind}"), "test", 0)


@pytest.mark.parametrize("name", FAMILY)
@pytest.mark.parametrize("people", [52, 500])
def test_worlds_hold_from_50_to_500_people_some_of_whom_ignore_the_robot(name, people):
    world = crowd(name, people, 0.25)
    agents = world.agents
    assert agents.evaluated.sum() == 1
    assert len(agents) == 1 + people
    robot = agents.team[agents.evaluated][0]
    blind = ~world.sees[agents.team, robot]
    assert blind.sum() == pytest.approx(people / 4, abs=2)
    assert world.sees[robot].all()


@pytest.mark.parametrize("name", FAMILY)
def test_speeds_are_mixed_as_published(name):
    speed = (agents := crowd(name, 500).agents).preferred_speed[~agents.evaluated]
    assert speed.mean() == pytest.approx(1.34, abs=0.04)
    assert speed.std() == pytest.approx(0.26, abs=0.04)
    assert len(np.unique(speed)) == 500


@pytest.mark.slow
def test_five_navigators_run_and_verify(tmp_path):
    few = [f"{name}:reactive=5,unaware=2" for name in FAMILY]
    run = benchnav.run(
        "people",
        scenarios=few,
        navigators=NAVIGATORS,
        seeds=1,
        out=tmp_path / "run",
        workers=0,
        quiet=True,
    )
    episodes = list(run.episodes())
    assert len(episodes) == len(FAMILY) * len(NAVIGATORS)
    assert not any(episode.record.failure for episode in episodes)
    assert run.verify(twin=1, twin_seconds=1.0, rerun=True, workers=0, quiet=True)
