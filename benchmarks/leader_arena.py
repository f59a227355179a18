"""Leader arena: 7 thick rays and a step with contacts, 1,024 worlds of `leaders/dynamic`.

Four unicycles per world drive at random. Contacts block and slide instead of ending an
attempt, so that all stay active among walls, cubes and movers; only active agents count.
Sensing and stepping are timed.
"""

from dataclasses import replace
from time import perf_counter

import numpy as np

from benchnav.arena.world import ContactRule, World
from benchnav.generation.build import build
from benchnav.scenario.catalogue import find
from benchnav.sensors.sense import sense
from benchnav.world.simulation import Simulation

WORLDS, DRAWN, STEPS, ROUNDS = 1024, 128, 25, 7
WANTED = 2e6  # agent-steps per second
RAYS = frozenset({"rays"})


def measure() -> list[dict[str, object]]:
    """Return one row: agent-steps per second, the best of `ROUNDS`."""
    scenario = find("leaders/dynamic")
    drawn = [sliding(build(scenario, "train", seed)) for seed in range(DRAWN)]
    worlds = [drawn[k % DRAWN] for k in range(WORLDS)]
    rates = [rate(Simulation(worlds), np.random.default_rng(k)) for k in range(ROUNDS + 1)]
    best = max(rates[1:])  # the first one compiles
    return [
        {
            "name": "leader arena, 1,024 × 4 agents, 7 rays, contacts",
            "value": best, "unit": "agent-steps/s", "wanted": WANTED, "ratio": best / WANTED,
        }
    ]  # fmt: skip


def sliding(world: World) -> World:
    """Return the same world with agents that slide after a contact."""
    return replace(world, rules=replace(world.rules, contact=ContactRule.SLIDE))


def rate(simulation: Simulation, rng: np.random.Generator) -> float:
    """Return agent-steps per second over STEPS steps of random driving."""
    chosen = np.tile(np.arange(simulation.A), (simulation.B, 1))
    twist = np.ones(chosen.shape, np.bool_)
    seconds, steps = 0.0, 0
    for _ in range(STEPS):
        command = np.stack(
            [rng.uniform(0.0, 2.0, chosen.shape), rng.normal(0.0, 1.0, chosen.shape)], axis=-1
        )
        active = (simulation.status == 0) & simulation.present
        steps += int(active.sum())
        began = perf_counter()
        sense(simulation, np.where(active, chosen, -1), RAYS)
        simulation.step(command, twist)
        seconds += perf_counter() - began
    return steps / seconds


if __name__ == "__main__":
    print(measure())
