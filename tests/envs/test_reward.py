"""The reward (Eq. 2-10): every term by hand, and against its twin."""

from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from benchnav.arena.solid import Kind
from benchnav.envs.reward import RewardTerms, RewardWeights, reward_of
from tests.reference import reward as slow

WEIGHTS = RewardWeights(
    goal=100, approach=2, static=3, dynamic=5, walls=7, agents=11, time=0.5, p_dynamic=13,
    turning=0.25,
)  # fmt: skip
NAMES = [f.name for f in fields(RewardTerms)]
TOUCHED = (Kind.AGENT, Kind.WALL, Kind.STATIC, Kind.DYNAMIC)


def of_one(weights=WEIGHTS, arrived=False, nearer=0.0, contacts=(), p=0.0, turned=0.0):
    counts = np.zeros((1, 1, len(Kind)), np.int64)
    for kind in contacts:
        counts[0, 0, kind] += 1
    terms, reward = reward_of(
        weights, acted=np.array([[True]]), arrived=np.array([[arrived]]),
        nearer=np.array([[nearer]]), contacts=counts, probability=np.array([[p]]),
        turned=np.array([[turned]]),
    )  # fmt: skip
    assert reward == weights.scale * terms.total
    return terms


def paid(**what):
    """Terms other than zero."""
    terms = of_one(**what)
    return {name: value for name in NAMES if (value := getattr(terms, name).item())}


def with_(**changes):
    return WEIGHTS.model_copy(update=changes)


def test_time_is_paid_for_every_decision():
    assert paid() == {"time": -0.5}


def test_arriving_and_approaching():
    assert paid(arrived=True) == {"time": -0.5, "goal": 100}
    assert paid(nearer=1e-6) == {"time": -0.5, "approach": 2}
    assert paid(nearer=-0.5) == paid(nearer=0.0) == {"time": -0.5}


@pytest.mark.parametrize(
    ("kind", "name", "weight"),
    [
        (Kind.STATIC, "static", 3),
        (Kind.DYNAMIC, "dynamic", 5),
        (Kind.WALL, "walls", 7),
        (Kind.AGENT, "agents", 11),
    ],
)
def test_every_contact_is_charged_by_its_kind(kind, name, weight):
    assert paid(contacts=[kind]) == {"time": -0.5, name: -weight}
    assert paid(contacts=[kind] * 3) == {"time": -0.5, name: -3 * weight}


def test_danger_withholds_what_the_goal_pays():
    assert paid(arrived=True, nearer=1.0, p=0.61) == {"time": -0.5, "p_dynamic": -13}


def test_the_threshold_itself_is_no_danger():
    assert paid(p=0.6, nearer=1.0) == {"time": -0.5, "approach": 2}
    assert paid(p=np.nextafter(0.6, 1), nearer=1.0) == {"time": -0.5, "p_dynamic": -13}
    assert "p_dynamic" not in paid(weights=with_(threshold=1.0), p=1.0)
    assert paid(weights=with_(threshold=0.0), p=1e-9)["p_dynamic"] == -13


def test_danger_spares_no_contact():
    assert paid(contacts=[Kind.DYNAMIC, Kind.WALL], p=1.0) == {
        "time": -0.5, "p_dynamic": -13, "dynamic": -5, "walls": -7
    }  # fmt: skip


def test_progress_is_paid_by_its_share():
    progress = with_(moving="progress")
    assert paid(weights=progress, nearer=0.25)["approach"] == 0.5
    assert paid(weights=progress, nearer=-0.25)["approach"] == -0.5
    assert paid(weights=progress, nearer=-0.25, p=0.9)["approach"] == -0.5
    assert "approach" not in paid(weights=progress, nearer=0.25, p=0.9)


def test_turning_is_priced_by_its_share():
    assert paid(turned=0.5)["turning"] == -0.125


def test_the_total_is_the_sum_of_all_terms():
    terms = of_one(
        arrived=True, nearer=0.5, contacts=[Kind.STATIC, Kind.AGENT, Kind.AGENT], turned=1.0
    )
    assert terms.total.item() == 100 + 2 - 3 - 22 - 0.5 - 0.25


@given(st.data())
def test_agrees_with_its_twin(data):
    weights = RewardWeights(
        **{name: data.draw(st.floats(0, 200)) for name in NAMES},
        threshold=data.draw(st.floats(0, 1)),
        moving=data.draw(st.sampled_from(["sign", "progress"])),
    )
    one = {
        "arrived": data.draw(st.booleans()),
        "nearer": data.draw(st.floats(-1, 1)),
        "contacts": data.draw(st.lists(st.sampled_from(TOUCHED), max_size=5)),
        "p": data.draw(st.one_of(st.floats(0, 1), st.just(weights.threshold))),
        "turned": data.draw(st.floats(0, 1)),
    }
    expected, terms = slow.terms(weights, **one), of_one(weights, **one)
    assert {name: getattr(terms, name).item() for name in NAMES} == pytest.approx(expected)
    assert terms.total.item() == pytest.approx(sum(expected.values()), abs=1e-9)


def test_a_batch_is_its_agents():
    rng = np.random.default_rng(0)
    B, A = 3, 4
    arrived, turned = rng.random((B, A)) < 0.3, rng.random((B, A))
    nearer, p = rng.uniform(-1, 1, (B, A)), rng.random((B, A))
    contacts = rng.integers(0, 3, (B, A, len(Kind)))
    acted = rng.random((B, A)) < 0.5
    terms, reward = reward_of(
        WEIGHTS,
        acted=acted,
        arrived=arrived,
        nearer=nearer,
        contacts=contacts,
        probability=p,
        turned=turned,
    )
    for at in np.ndindex(B, A):
        kinds = [kind for kind in TOUCHED for _ in range(contacts[at][kind])]
        expected = slow.terms(WEIGHTS, arrived[at], nearer[at], kinds, p[at], turned[at])
        assert {name: getattr(terms, name)[at] for name in NAMES} == pytest.approx(expected)
        paid_now = WEIGHTS.scale * sum(expected.values()) if acted[at] else 0.0
        assert reward[at] == pytest.approx(paid_now)


@pytest.mark.parametrize(
    "wrong",
    [{"goal": -1}, {"threshold": 1.1}, {"scale": 0}, {"time": float("nan")}, {"moving": "fast"},
     {"static": float("inf")}, {"wall": 5}],
)  # fmt: skip
def test_impossible_weights_are_refused(wrong):
    with pytest.raises(ValidationError):
        RewardWeights(**wrong)
