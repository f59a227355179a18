"""The weights that ship do what their cards say, within chance."""

import numpy as np
import pytest

from benchnav.generation.build import build
from benchnav.metrics.success import success
from benchnav.runner.rollouts.rollout import Assignment, rollout
from benchnav.scenario.catalogue import find

WORLDS = 50  # of four agents: 200 episodes of an agent


def share(navigator, name):
    scenario = find(name)
    about = Assignment(
        scenario.identity, scenario.hash, "validation", "unknown", navigator, navigator, salt="00"
    )
    worlds = [(seed, build(scenario, "validation", seed)) for seed in range(WORLDS)]
    return np.mean([success(episode) for batch in rollout(about, worlds) for episode in batch])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("navigator", "scenario", "least"),  # three standard errors or more below the cards
    [
        ("q-learning", "leaders/static", 0.93),
        ("q-learning", "leaders/dynamic", 0.79),
        ("recurrent-ppo", "leaders/static", 0.96),
        ("recurrent-ppo", "leaders/dynamic", 0.88),
        ("recurrent-ppo-vo", "leaders/static", 0.98),
        ("recurrent-ppo-vo", "leaders/dynamic", 0.96),
        ("recurrent-ppo-plus", "leaders/static", 0.98),
        ("recurrent-ppo-plus", "leaders/dynamic", 0.96),
    ],
)
def test_success_of_what_ships(navigator, scenario, least):
    assert share(navigator, scenario) >= least
