"""Noisy neighbours keep their shapes: sorted, missed and turned together with their places."""

import numpy as np
import pytest

from benchnav.arena.noise import NeighbourNoise, Noise, OdometryNoise
from benchnav.generation.build import build
from benchnav.geometry.rotation import wrap
from benchnav.scenario.load import scenario_from_text
from benchnav.sensors.readings import FORM
from benchnav.sensors.sense import sense
from tests.sensors.noisy import NEEDS, active, noisy

TEXT = """\
name: tests/shapes
bounds: [-6, -6, 6, 6]
teams:
  - name: watchers
    count: 3
    radius: 0.2
    max_speed: 1
    heading: 0
    start: {type: points, points: [[0, 0], [1, 3], [-2, -2]]}
    goal: {type: points, points: [[5, 0], [5, 3], [5, -2]]}
  - name: boxes
    count: 6
    max_speed: 1
    heading: {uniform: [-3, 3]}
    footprint: {type: rounded-box, length: {uniform: [0.5, 0.9]}, width: 0.3, corner_radius: 0.1}
    start: {type: region, region: {type: anywhere}}
    goal: {type: region, region: {type: anywhere}}
"""


@pytest.fixture(scope="module")
def worlds():
    scenario = scenario_from_text(TEXT, "shapes.yaml")
    return [build(scenario, "test", seed) for seed in range(4)]


def shapes(near, b, i):
    """(n, 4) heading, half length, half width and rounding of the neighbours of an agent."""
    return np.stack([getattr(near, name)[b, i, : near.count[b, i]] for name in FORM], axis=-1)


def test_shapes_stay_with_their_neighbours(worlds):
    simulation, senses = noisy(worlds, Noise(neighbours=NeighbourNoise(0.3, 0.0, 0.3, 0.5)))
    exact = sense(simulation, np.where(active(simulation, senses), senses._chosen, -1), NEEDS, {})[
        1
    ]
    near = senses.sense(active(simulation, senses), NEEDS)[1]
    missed = false = shaped = 0
    for b, i in np.argwhere(simulation.present):
        known, found = shapes(exact, b, i).tolist(), shapes(near, b, i).tolist()
        discs = [shape for shape in found if shape[1] == 0.0]
        assert all(shape == [0.0] * 4 for shape in discs)
        assert all(shape in known for shape in found if shape[1] > 0.0)
        shaped += len(found) - len(discs)
        missed += sum(shape not in found for shape in known)
        false += len(discs) > sum(shape[1] == 0.0 for shape in known)
        assert shapes_behind(near, b, i) == 0.0
    assert shaped > 50
    assert missed > 5
    assert false > 0


def shapes_behind(near, b, i):
    """The largest number of the shapes behind the last neighbour."""
    parts = [getattr(near, name)[b, i, near.count[b, i] :] for name in FORM]
    return max((float(np.abs(part).max(initial=0.0)) for part in parts), default=0.0)


def test_shapes_turn_with_the_frame(worlds):
    noise = Noise(odometry=OdometryNoise(0.05, 0.05, 0.05, 0.2, 0.05, 0.4))
    simulation, senses = noisy(worlds, noise)
    command = np.zeros((simulation.B, simulation.A, 2))
    turned = 0
    for _ in range(3):
        deciding = active(simulation, senses)
        exact = sense(simulation, np.where(deciding, senses._chosen, -1), NEEDS, {})[1]
        near = senses.sense(deciding, NEEDS)[1]
        for b, i in np.argwhere(simulation.present):
            known, found = shapes(exact, b, i), shapes(near, b, i)
            drift = float(senses.pose_error[b, i, 2])
            for before, after in zip(known, found, strict=True):
                expected = wrap(before[0] + drift) if before[1] > 0.0 else 0.0
                np.testing.assert_allclose(after, [expected, *before[1:]], atol=1e-12)
                turned += bool(before[1] > 0.0 and drift != 0.0)
        simulation.step(command, np.ones(command.shape[:2], bool))
    assert turned > 50
