"""Prints a digest of states, contacts and readings; run as a program under other settings."""

import hashlib
import sys

import numpy as np

from benchnav.arena.world import ContactRule
from benchnav.sensors.sense import sense
from benchnav.world.simulation import Simulation
from tests.worlds import random_world

SENSORS = frozenset({"rays", "neighbours", "edges"})


def digest(steps: int) -> str:
    """Of two batches: few unicycles that slide, and many holonomic agents that stop."""
    found = hashlib.sha256()
    for unicycle, contact, count in ((True, ContactRule.SLIDE, 4), (False, ContactRule.STOP, 30)):
        worlds = [
            random_world(seed, count, contact, unicycle, steps=steps, radius=0.2)
            for seed in range(3)
        ]
        simulation = Simulation(worlds)
        rng = np.random.default_rng(0)
        chosen = np.tile(np.arange(simulation.A), (simulation.B, 1))
        twist = rng.random((simulation.B, simulation.A)) < 0.5
        for _ in range(steps):
            simulation.step(rng.normal(size=(simulation.B, simulation.A, 2)) * 2.0, twist)
            for array in (simulation.position, simulation.heading, simulation.velocity):
                found.update(np.ascontiguousarray(array).tobytes())
            readings = sense(simulation, np.where(simulation.present, chosen, -1), SENSORS)
            found.update(readings[0].distance.tobytes())
            found.update(readings[1].position.tobytes())
            found.update(readings[2].start.tobytes())
        for b in range(3):
            events = simulation.contacts(b)
            found.update(events.start.tobytes() + events.closing_speed.tobytes())
    return found.hexdigest()


if __name__ == "__main__":
    print(digest(int(sys.argv[1])))
