"""Plans of one who knows everything, driven by the real simulator."""

from dataclasses import replace

import numpy as np
import pytest

from benchnav.arena.agents import Dynamics
from benchnav.arena.world import ContactRule
from benchnav.episode.episode import Status
from benchnav.errors import UsageError
from benchnav.generation.build import build
from benchnav.scenario.catalogue import find
from benchnav.world.simulation import Simulation
from studies.full_knowledge.measure import driven, execute, measure, outcome, summary
from studies.full_knowledge.plan import plans
from studies.full_knowledge.scene import scene

ARRIVED = int(Status.ARRIVED)


def drawn(seed, name="leaders/dynamic"):
    return build(find(name), "test", seed)


def test_the_simulator_takes_the_agents_where_the_plan_says():
    world = drawn(0)
    *_, made = plans(world, 0)
    simulation, substeps = Simulation([world]), world.clock.substeps
    for step in range(max(len(plan.commands) for plan in made)):
        execute(simulation, made, step)
        for i in np.flatnonzero(simulation.status[0] == int(Status.ACTIVE)):
            expected = made[i].path[(step + 1) * substeps]
            np.testing.assert_allclose(simulation.position[0, i], expected, rtol=0, atol=1e-9)
    assert (simulation.status[0] == ARRIVED).all()


def test_all_arrive_among_movers():
    outcomes = measure("leaders/dynamic", "test", range(3))
    assert all(o.arrived == o.agents == 4 for o in outcomes)
    assert all(o.collided == o.not_found == o.broken == 0 for o in outcomes)


def test_a_plan_lasts_until_the_decision_in_which_the_agent_arrives():
    world = drawn(1)
    *_, made = plans(world, 0)
    shorter = [replace(plan, commands=plan.commands[:-1]) for plan in made]
    assert (driven(world, made) == ARRIVED).all()
    assert (driven(world, shorter) != ARRIVED).all()


def test_plans_are_the_same_for_the_same_seed():
    first, second = (list(plans(drawn(2), 5))[-1] for _ in range(2))
    for one, other in zip(first, second, strict=True):
        np.testing.assert_array_equal(one.commands, other.commands)


def test_whose_way_crosses_a_start_is_planned_otherwise():
    """Agents 0 and 2 start side by side and run each other over in the first round."""
    world = drawn(153, "leaders/moved")
    rounds = list(plans(world, 153))
    assert not all(plan.found for plan in rounds[0])
    assert (driven(world, rounds[-1]) == ARRIVED).all()


def test_who_cannot_be_saved_is_said_apart():
    """Agent 0 faces a mover that runs it over within 0.6 s, and cannot drive backwards."""
    seen = outcome(drawn(380), 380)
    assert (seen.arrived, seen.collided, seen.not_found, seen.broken) == (3, 1, 1, 0)


def test_a_summary_counts_agents_and_clusters_them_by_world():
    done = outcome(drawn(0), 0)
    half = replace(done, seed=1, arrived=2, not_found=2)
    row = summary("leaders/dynamic", "test", [done, half] * 10)
    assert (row.worlds, row.agents, row.success, row.not_found) == (20, 80, 0.75, 0.25)
    assert row.low < 0.75 < row.high
    assert row.incomplete == [1] * 10
    assert "success 0.7500 [" in str(row)


def test_furniture_that_moves_meanwhile_is_refused():
    with pytest.raises(UsageError, match="no static obstacle that moves meanwhile"):
        scene(drawn(0, "leaders/moving-furniture"))


def test_other_bodies_and_rules_are_refused():
    world = drawn(0)
    round_ones = np.full(len(world.agents), int(Dynamics.HOLONOMIC), np.int8)
    other = replace(
        world,
        agents=replace(world.agents, dynamics=round_ones),
        rules=replace(world.rules, contact=ContactRule.SLIDE),
    )
    with pytest.raises(UsageError, match="needs unicycles only, contacts that end"):
        scene(other)
