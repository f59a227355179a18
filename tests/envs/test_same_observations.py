"""Training and evaluation show the same: environments and the runner give equal observations."""

from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest

from benchnav.arena.world import Afterwards, ContactRule
from benchnav.envs.agent_batch import AgentBatch
from benchnav.envs.background_agents import BackgroundNavigator
from benchnav.envs.encoders.catalogue import encoder
from benchnav.envs.reward import RewardWeights
from benchnav.generation.build import build, noise_of
from benchnav.navigation.navigator import Navigator, Need
from benchnav.plugins import NAVIGATORS
from benchnav.runner.rollouts.navigator_driver import Driver
from benchnav.scenario.catalogue import find
from benchnav.testing.observations import observations_of
from benchnav.world.simulation import Simulation

DECISIONS = 60
SENSORS = frozenset({Need.RAYS, Need.NEIGHBOURS, Need.EDGES})


def worlds_of(scenario):
    """Four worlds under the contact rule of training, in which a contact ends the attempt."""
    drawn = [build(find(scenario), "train", seed) for seed in range(4)]
    rules = replace(drawn[0].rules, contact=ContactRule.END, on_end=Afterwards.VANISH)
    return [replace(world, rules=rules) for world in drawn]


class Wanderer(Navigator):
    """Records what it sees; its twists follow from where its agents stand."""

    needs = SENSORS | {Need.MAP}
    command = "twist"

    def __init__(self, config=None):
        super().__init__(config)
        self.seen = []

    def act(self, observation):
        self.seen.append(observation)
        return 2.0 * actions(observation.position)


def actions(position):
    """(B, A, 2) in [-1, 1], different for every agent and decision."""
    return np.sin(3.0 * position + np.array([0.7, 0.0]))


def assert_equal(a, b, rows=None):
    """Every array of two observations has the same bits, in the worlds ``rows``."""
    assert type(a) is type(b)
    for f in fields(a):
        x, y = getattr(a, f.name), getattr(b, f.name)
        if is_dataclass(x):
            assert_equal(x, y)
        elif isinstance(x, np.ndarray):
            assert x.dtype == y.dtype, f.name
            np.testing.assert_array_equal(x, y, f.name)


def step_of(batch, command):
    """Step the batch with twists (B, A, 2) instead of actions."""
    simulation = batch.simulation
    simulation.step = lambda _, twist: Simulation.step(simulation, command.copy(), twist)
    return batch.step(np.zeros_like(command))


@pytest.mark.parametrize("noisy", [False, True])
@pytest.mark.parametrize(
    "scenario", ["leaders/dynamic", "leaders/moving-furniture", "corridor/bidirectional"]
)
def test_an_environment_shows_a_learner_what_the_runner_shows_a_navigator(scenario, noisy):
    worlds = worlds_of(scenario)
    noise = replace(noise_of(find(scenario)), delay=2) if noisy else None
    wanderer, simulation = Wanderer(), Simulation(worlds)
    driver = Driver(wanderer, simulation, 0, "unknown", noise=noise)
    rng = np.random.default_rng(0)
    batch = AgentBatch(worlds, len(worlds), encoder("ego"), RewardWeights(), rng, noise=noise)
    batch._needs = SENSORS
    batch.reset(np.arange(len(worlds)))
    keys = batch._senses._keys if noisy else None
    driver.reset([np.random.default_rng(b) for b in range(len(worlds))], keys)
    alive, compared = np.ones(len(worlds), bool), 0
    for _ in range(DECISIONS):
        going = np.flatnonzero(alive & simulation.running)
        command = np.zeros((simulation.B, simulation.A, 2))
        driver.act(command, float(simulation.steps_done.max() * worlds[0].clock.dt))
        shown = wanderer.seen[-1]
        trained = batch._observe(batch.active).select(going)
        kept = np.flatnonzero(np.isin(shown.rows, going))
        assert_equal(trained, replace(shown.select(kept), maps=(None,) * len(kept)))
        compared += len(going)
        twist = np.ones(command.shape[:2], bool)
        simulation.step(command, twist)
        alive &= ~step_of(batch, command).restarted.any(1)
        if not (alive & simulation.running).any():
            break
    assert compared > 40


def test_the_navigator_of_the_other_agents_sees_in_training_what_it_sees_in_a_run(monkeypatch):
    worlds = worlds_of("leaders/moving-furniture")
    monkeypatch.setitem(NAVIGATORS._local, "tests-wanderer", (Wanderer, "tests:Wanderer"))
    wanderer, simulation = Wanderer(), Simulation(worlds)
    driver = Driver(wanderer, simulation, 0, "known")
    driver.reset([np.random.default_rng(b) for b in range(len(worlds))])
    rng = np.random.default_rng(0)
    batch = AgentBatch(worlds, len(worlds), encoder("ego"), RewardWeights(), rng)
    batch.reset(np.arange(len(worlds)))
    others = BackgroundNavigator("tests-wanderer", batch.simulation, batch.width, "others")
    everybody = [np.arange(len(world.agents)) for world in worlds]
    rows = np.arange(len(worlds))
    others.start(rows, everybody, [np.random.default_rng(b) for b in rows])
    for _ in range(DECISIONS):
        command = np.zeros((simulation.B, simulation.A, 2))
        driver.act(command, float(simulation.steps_done.max() * worlds[0].clock.dt))
        instead = others.decide(batch.active)
        shown, trained = wanderer.seen[-1], others._navigator.seen[-1]
        assert_equal(trained, shown)
        for one, other in zip(trained.maps, shown.maps, strict=True):
            assert one.revision == other.revision
            np.testing.assert_array_equal(one.capsules, other.capsules)
        np.testing.assert_array_equal(instead.command, command)
        simulation.step(command, np.ones(command.shape[:2], bool))
        if batch.step(np.zeros_like(command), instead).restarted.any():
            break
    assert len(wanderer.seen) > 8


def test_checks_of_navigators_show_what_the_runner_shows():
    worlds = worlds_of("leaders/dynamic")
    wanderer, simulation = Wanderer(), Simulation(worlds)
    driver = Driver(wanderer, simulation, 0, "known")
    driver.reset([np.random.default_rng(b) for b in range(len(worlds))])
    for checked in observations_of(worlds, Wanderer.needs):
        driver.act(np.zeros((simulation.B, simulation.A, 2)), 0.0)
        assert_equal(checked, wanderer.seen[-1])
        way = simulation.goal - simulation.position
        away = np.maximum(np.sqrt(np.sum(way * way, axis=2, keepdims=True)), 1e-9)
        speed = simulation.agents["preferred_speed"][..., None]
        simulation.step(speed * way / away, np.zeros((simulation.B, simulation.A), bool))
