"""The trajectory of RVO2's own Circle example, from the unmodified program."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
from benchnav_baselines.controllers.orca.kernel import avoid

DATA = Path(os.environ.get("BENCHNAV_DATA", Path(__file__).parents[3] / "shared" / "data"))


def nearest(position, reach, most):
    """(A, most) indices of the others within ``reach``, nearest first, and (A,) how many."""
    distance2 = ((position[:, None] - position[None]) ** 2).sum(-1)
    np.fill_diagonal(distance2, np.inf)
    order = np.argsort(distance2, axis=1, kind="stable")[:, :most]
    count = (np.take_along_axis(distance2, order, 1) < reach**2).sum(1)
    return order, count


def step(position, velocity, goal, setting, dt):
    """One step of RVO2: (position, velocity) afterwards."""
    agents = len(position)
    wanted = goal - position
    length = np.hypot(*wanted.T)[:, None]
    wanted = np.where(length > 1.0, wanted / np.maximum(length, 1.0), wanted)
    order, count = nearest(position, setting["neighborDist"], setting["maxNeighbors"])
    own = np.column_stack(
        [
            position,
            velocity,
            wanted,
            np.full((agents, 3), (setting["radius"], setting["maxSpeed"], 1 / dt)),
        ]
    )
    nothing, flag = np.zeros((agents, 0, 2)), np.zeros((agents, 0), bool)
    answer = np.zeros((agents, 2))
    avoid(
        0, agents, own, np.ones(agents, bool),
        position[order], velocity[order], np.full(order.shape, setting["radius"] * 1.0),
        np.ones(order.shape, np.int8), count,
        nothing, nothing, nothing, nothing, flag, flag, np.zeros(agents, np.int64),
        setting["maxNeighbors"], 0.0, np.zeros(agents), 1 / setting["timeHorizon"],
        1 / setting["timeHorizonObst"], answer,
    )  # fmt: skip
    return position + dt * answer, answer


def test_first_fifty_seconds_of_rvo2_circle():
    if not (DATA / "rvo2").is_dir():
        pytest.skip(f"{DATA / 'rvo2'} is absent")
    scenario = json.loads((DATA / "rvo2" / "circle.scenario.json").read_text())
    with np.load(DATA / "rvo2" / "Circle_reference.npz") as reference:
        expected = reference["pos_first"].astype(float)
    position = np.array([agent["p"] for agent in scenario["agents"]])
    goal = np.array([agent["g"] for agent in scenario["agents"]])
    velocity = np.zeros_like(position)
    worst = 0.0
    for there in expected[1:]:
        position, velocity = step(
            position, velocity, goal, scenario["agent_defaults"], scenario["time_step"]
        )
        worst = max(worst, float(np.abs(position - there).max()))
    assert len(expected) == 201
    assert worst < 5e-3


def test_a_few_agents_cross_without_touching():
    angle = np.array([0.0, 1.1, 2.3, 3.0, 4.4, 5.2])
    position = 10.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    goal, velocity = -position, np.zeros_like(position)
    setting = {
        "neighborDist": 15, "maxNeighbors": 5, "radius": 0.5, "maxSpeed": 2,
        "timeHorizon": 5, "timeHorizonObst": 5,
    }  # fmt: skip
    smallest = np.inf
    for _ in range(160):
        position, velocity = step(position, velocity, goal, setting, 0.25)
        gaps = np.hypot(*np.moveaxis(position[:, None] - position[None], -1, 0))
        smallest = min(smallest, float(gaps[~np.eye(6, dtype=bool)].min()))
    assert 2 * 0.5 - 1e-6 < smallest < 2 * 0.5 + 0.2
    assert np.abs(position - goal).max() < 0.1
