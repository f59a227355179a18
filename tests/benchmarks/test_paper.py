"""The page about the paper: what it counts, how it judges, and that it can be made."""

import math
from pathlib import Path

import numpy as np
import pytest

from benchnav.arena.solid import Kind
from benchnav.errors import UsageError
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.rollouts.rollout import Assignment, rollout
from benchnav.runner.run import run_suite
from studies.paper import cast, claims
from studies.paper.encounters import TURN, behaviour
from studies.paper.evidence import Difference, Evidence, Value
from studies.paper.page import page
from studies.paper.pictures import Pictures
from studies.paper.table_2 import ROWS, commands
from tests.worlds import agents, back_and_forth, box, world

DOCS = Path(__file__).parents[2] / "docs"


def crossing(speed, agent_speed=1.0):
    """An agent that goes east, and a cube that goes south across its way."""
    mover = back_and_forth(box(Kind.DYNAMIC, 0, 0, 0.5, 0.5), (4, 6), (4, -60), speed)
    us = agents([(-2, 0)], [(9, 0)], radius=0.5, speed=agent_speed)
    scene = world(us, bodies=[mover])
    about = Assignment("made/up@1", "", "test", "unknown", "us", "straight-line", salt="00")
    ((episode,),) = rollout(about, [(0, scene)])
    return episode


def test_an_encounter_is_a_predicted_collision_and_knows_whether_it_came():
    # both would be at (4, 0) after 6 s; the alarm comes 1 / 0.6 s before the circles meet
    found = behaviour([crossing(speed=1.0)]).encounters
    assert len(found) == 1
    assert found[0].hit
    dt, reach = 0.2, 0.5 + math.hypot(0.5, 0.5)
    meet = (6.0 * math.sqrt(2) - reach) / math.sqrt(2)
    assert found[0].alarm * dt == pytest.approx(meet - 1 / 0.6, abs=2 * dt)
    assert found[0].turned < TURN


def test_what_passes_well_before_is_no_encounter():
    assert not behaviour([crossing(speed=3.0)]).encounters


def test_numbers_say_what_is_not_known():
    assert Value(math.nan, math.nan, math.nan, 0).text() == "–"
    assert Value(0.5, math.nan, math.nan, 1).text(100) == "50.0"
    assert Value(-0.001, -0.01, 0.2, 9).text(1, 1) == "0.0 [0.0, 0.2]"
    assert Difference(0.031, 0.01, 0.05, 9, 0.01).text(100) == "+3.1 [1.0, 5.0]"


@pytest.mark.parametrize(
    ("change", "verdict"),
    [
        (Difference(-0.2, -0.3, -0.1, 50, 0.001), claims.CONFIRMED),
        (Difference(0.2, 0.1, 0.3, 50, 0.001), claims.CONTRADICTED),
        (Difference(-0.2, -0.5, 0.1, 50, 0.2), claims.NOT),
        (Difference(-0.2, -0.3, -0.1, 50, 0.06), claims.NOT),
    ],
)
def test_a_comparison_is_confirmed_only_where_it_is_sure(change, verdict):
    assert claims._compared(change, -1) == verdict


@pytest.mark.parametrize(
    ("hits", "fewer", "verdict"),
    [
        (Value(0.005, 0.001, 0.01, 100), Difference(0.0, -0.1, 0.1, 100, 0.9), claims.CONFIRMED),
        (Value(0.1, 0.05, 0.2, 100), Difference(-0.1, -0.2, -0.05, 100, 0.01), claims.PARTLY),
        (Value(0.02, 0.005, 0.04, 100), Difference(-0.1, -0.2, -0.05, 100, 0.01), claims.PARTLY),
        (Value(0.1, 0.05, 0.2, 100), Difference(-0.1, -0.2, 0.05, 100, 0.2), claims.CONTRADICTED),
        (Value(0.1, 0.05, 0.2, 100), Difference(0.1, 0.05, 0.2, 100, 0.01), claims.CONTRADICTED),
        (Value(0.02, 0.005, 0.04, 100), Difference(0.0, -0.1, 0.1, 100, 0.9), claims.NOT),
    ],
)
def test_movers_are_avoided_with_few_hits_and_in_part_with_fewer(hits, fewer, verdict):
    assert claims.avoided(hits, fewer) == verdict


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The whole suite on one seed."""
    folder = tmp_path_factory.mktemp("paper") / "run"
    run_suite(load_suite("paper", Selection(seeds="1")), folder, workers=0)
    return folder


@pytest.mark.long
def test_the_page_is_made_from_a_run_of_the_suite(run, tmp_path):
    text = page(run, Pictures(tmp_path))
    for about, _ in claims.CLAIMS:
        assert text.count(f"| {about} |") == 1
    assert all(f"| `{row.navigator}` |" in text for row in ROWS)
    assert {p.name for p in tmp_path.iterdir()} == {
        "paper-groups.png", "paper-learning.png", "paper-movers.png",
    }  # fmt: skip
    evidence = Evidence.of(run)
    cell = (cast.STATIC, "known", cast.LOCAL)
    values = [v for v, _ in evidence.values[cell, "leader", "success"].values()]
    assert evidence.value("success", cell).mean == pytest.approx(np.mean(values))
    assert evidence.alike("success", [cell, (cast.STATIC, "unknown", cast.LOCAL)])
    assert commands(evidence, (cast.STATIC, "unknown", cast.TABULAR))[0] <= 15
    with pytest.raises(UsageError, match="must hold 'success' of leaders/static / partial / orca"):
        evidence.value("success", (cast.STATIC, "partial", cast.LOCAL))


def test_the_kept_page_has_every_claim_and_method():
    text = (DOCS / "paper.md").read_text("utf-8")
    assert [about for about, _ in claims.CLAIMS if f"| {about} |" not in text] == []
    assert [row.navigator for row in ROWS if f"| `{row.navigator}` |" not in text] == []
