"""Worlds in lockstep: no batching shows in the results, and everybody pays only for themselves."""

import pickle
import re
from collections import Counter

import numpy as np
import pytest

from benchnav.arena.solid import Kind
from benchnav.episode.episode import Status
from benchnav.generation.build import build
from benchnav.runner.rollouts import rollout as module
from benchnav.scenario.load import load_scenario
from benchnav.store.parts.digest import digest


def digests(episodes):
    return {seed: episode.digest for seed, episode in episodes.items()}


@pytest.mark.parametrize("navigator", ["Walk", "orca"])
def test_no_batch_size_changes_a_bit(play, monkeypatch, navigator):
    together = digests(play(navigator, range(7)))
    for size in (1, 3):
        monkeypatch.setattr(module, "MAX_WORLDS", size)
        assert digests(play(navigator, range(7))) == together
    assert digests(play(navigator, [6, 2])) == {s: together[s] for s in (6, 2)}
    assert len(set(together.values())) == 7


def test_what_is_recorded_fits_together(play):
    for seed, episode in play("orca").items():
        world, steps = episode.world, len(episode.requested)
        agents, bodies = len(world.agents), len(world.bodies)
        assert episode.position.shape == (steps + 1, agents, 2)
        assert episode.heading.shape == episode.status.shape == (steps + 1, agents)
        assert episode.executed.shape == (steps, agents, 2)
        assert episode.body_position.shape == (steps + 1, bodies, 2)
        assert episode.timings.decision.shape == (steps,)
        assert (episode.timings.decision > 0).all()
        assert np.array_equal(episode.position[0], world.agents.start)
        assert episode.digest == digest(episode)
        assert episode.identity.seed == seed
        assert (episode.failure, episode.reproducible) == ("", True)
        mine = world.agents.evaluated
        ended = (episode.status[-1, mine] != Status.ACTIVE).all()
        assert ended or steps == world.clock.steps
        assert (episode.status[:-1, mine] == Status.ACTIVE).any(axis=1).all()


def test_the_background_is_driven_recorded_and_the_same_for_everybody(play):
    walk, orca = play("Walk"), play("orca")
    for seed in walk:
        background = np.flatnonzero(~walk[seed].world.agents.evaluated)
        assert len(background) == 1
        assert np.abs(walk[seed].requested[0, background]).max() > 0.1
        assert np.array_equal(
            walk[seed].requested[0, background], orca[seed].requested[0, background]
        )


def test_requests_are_kept_as_they_were_and_executed_within_limits(play):
    for episode in play("Walk").values():
        speed = np.hypot(*np.moveaxis(episode.executed, 2, 0))
        assert (speed <= episode.world.agents.max_speed + 1e-12).all()
    asked = np.concatenate([e.requested.reshape(-1, 2) for e in play("Walk").values()])
    assert np.hypot(*asked.T).max() > 1.5


def test_twists_reach_the_agents_as_twists(play):
    for episode in play("Rotor").values():
        mine = np.flatnonzero(episode.world.agents.evaluated)
        assert (episode.requested[0, mine] == [0.5, 0.3]).all()
        turned = episode.heading[1, mine] - episode.heading[0, mine]
        assert np.abs(turned).max() > 0.0


def unnumbered(reason):
    """Without the number of the line, which no test is to know."""
    return re.sub(r"\.py:\d+", ".py:N", reason)


FAILURES = {
    "Raises": "act raised ValueError: lost my way (troubled_navigators.py:N) at t = 0.6 s",
    "Nan": r"act must return finite numbers. Got (",
    "Shape": "act must return an array of shape (1, ",
    "Nothing": "Got None instead at t = 0.6 s",
    "Leaves": "act raised SystemExit: bye (troubled_navigators.py:N) at t = 0.6 s",
    "ResetRaises": "reset raised RuntimeError: no plan (troubled_navigators.py:N)",
}


@pytest.mark.parametrize("navigator", FAILURES)
def test_a_failure_costs_its_own_episodes_only(play, in_the_east, navigator):
    """The others end bit for bit as with a navigator that never fails."""
    whole, episodes = play("Walk", range(9)), play(navigator, range(9))
    failed = {seed for seed, e in episodes.items() if e.failure}
    assert failed == {seed for seed, e in whole.items() if in_the_east(e)}
    assert 0 < len(failed) < 9
    for seed, episode in episodes.items():
        if seed not in failed:
            assert episode.digest == whole[seed].digest
            continue
        assert FAILURES[navigator] in unnumbered(episode.failure)
        raised = " raised " in episode.failure
        assert episode.traceback.startswith("Traceback (most recent") == raised
        steps = 0 if navigator == "ResetRaises" else 3
        assert len(episode.requested) == steps
        assert np.array_equal(episode.position[: steps + 1], whole[seed].position[: steps + 1])
        mine = episode.world.agents.evaluated
        assert (episode.status[-1, mine] == Status.FAILED).all()
        assert np.isnan(episode.arrival[mine]).all()


@pytest.mark.parametrize("how", ["nan", "raise"])
def test_worlds_that_fail_one_after_another_start_again_a_few_times(play, monkeypatch, how):
    from troubled_navigators import Staggered

    monkeypatch.setattr(Staggered, "how", how)
    monkeypatch.setattr(Staggered, "resets", [])
    episodes = play("Staggered", range(32))
    assert all(episode.failure for episode in episodes.values())
    assert len({len(episode.requested) for episode in episodes.values()}) > 15
    begun = Counter(Staggered.resets)
    assert len(begun) == 32
    assert max(begun.values()) <= 1 + 5


def test_who_can_do_only_one_world_at_a_time_is_run_one_world_at_a_time(play):
    alone = play("Alone")
    assert digests(alone) == digests(play("Walk"))
    assert {e.timings.batch for e in alone.values()} == {1}


def test_a_background_that_fails_is_told_from_the_navigator(play, in_the_east):
    episodes = play("orca", range(9), background=("troubled_navigators:ResetRaises",))
    reasons = {unnumbered(e.failure) for e in episodes.values()}
    expected = (
        "the scenario's background navigator 'troubled_navigators:ResetRaises':"
        " reset raised RuntimeError: no plan (troubled_navigators.py:N)"
    )
    assert reasons == {"", expected}


def test_what_a_navigator_is_handed_is_its_own(play):
    assert digests(play("Vandal")) == digests(play("Walk"))


def test_one_agent_at_a_time_is_as_good_as_a_batch(play):
    for episode in play("Agentwise").values():
        assert episode.failure == ""
        assert len(episode.requested) > 0


def test_a_charged_world_is_recorded_without_being_run(play):
    for episode in play("Dies", charge="killed by SIGSEGV").values():
        assert episode.failure == "killed by SIGSEGV"
        assert len(episode.requested) == 0
        assert (episode.status[-1, episode.world.agents.evaluated] == Status.FAILED).all()


@pytest.fixture
def seen(troubled):
    """What the navigator `Sees` is told and shown."""
    from troubled_navigators import Sees

    Sees.briefed.clear()
    Sees.shown.clear()
    return Sees


def furniture(scenario, tmp_path):
    """The tiny scenario with a disc that is moved at t = 1 s."""
    text = (scenario.folder / "tiny.yaml").read_text()
    moved = "static:\n  - shape: {type: disc, radius: 0.2}\n    count: 1\n    relocate_at: 1\n"
    moved += "    region: {type: anywhere, margin: 1}\n"
    path = tmp_path / "furniture.yaml"
    path.write_text(text.replace("static:\n", moved, 1))
    return load_scenario(path)


@pytest.mark.parametrize("track", ["known", "stale", "partial", "unknown"])
def test_the_map_is_what_the_track_grants_and_moves_in_known_alone(
    play, seen, scenario, tmp_path, track
):
    worlds = [(seed, build(furniture(scenario, tmp_path), "test", seed)) for seed in range(4)]
    play("Sees", track=track, worlds=worlds)
    if track == "unknown":
        assert {briefing.map for briefing in seen.briefed} == {None}
        assert {map_ for shown in seen.shown for map_ in shown.maps} == {None}
        return
    assert all(briefing.map.revision == 0 for briefing in seen.briefed)
    revisions = [(t, m.revision) for o in seen.shown for t, m in zip(o.time, o.maps, strict=True)]
    assert all(revision == 0 for t, revision in revisions if t <= 1.0)
    assert any(revision == 1 for _, revision in revisions) == (track == "known")
    statics = {sum(s.kind == Kind.STATIC for s in b.map.solids) for b in seen.briefed}
    assert statics == {0} if track == "partial" else min(statics) >= 1


def test_nothing_in_a_briefing_names_the_scenario_or_the_seed(play, seen):
    play("Sees", seeds=[123456789])
    (briefing,) = seen.briefed
    said = repr({name: getattr(briefing, name) for name in briefing.__dataclass_fields__})
    assert "123456789" not in said
    assert "tiny" not in said
    assert "123456789" not in str(vars(briefing.rng.bit_generator.seed_seq))


def met(seen, episodes):
    """Seeds in the order in which a navigator was briefed for them."""
    starts = {
        e.world.agents.start[e.world.agents.evaluated].tobytes(): s for s, e in episodes.items()
    }
    return [starts[briefing.start.tobytes()] for briefing in seen.briefed]


def test_the_order_of_rows_depends_on_the_salt_and_changes_nothing(play, seen):
    orders, whole = set(), digests(play("orca", range(7), salt="00"))
    for salt in ("00", "01", "02", "03"):
        seen.briefed.clear()
        orders.add(tuple(met(seen, play("Sees", range(7), salt=salt))))
    assert len(orders) == 4
    assert tuple(range(7)) not in orders
    assert digests(play("orca", range(7)[::-1], salt="00")) == whole


def test_no_salt_is_handed_to_a_navigator(play, seen):
    salt = "0123456789abcdef" * 2
    play("Sees", [0], salt=salt)
    handed = pickle.dumps((seen.briefed, seen.shown))
    assert salt.encode() not in handed
    assert bytes.fromhex(salt) not in handed


def test_worlds_that_are_over_are_shown_no_more(play, seen):
    episodes = play("Sees", range(5))
    order = met(seen, episodes)
    by_row = dict(enumerate(order))
    for shown in seen.shown:
        running = [s for s, e in episodes.items() if len(e.requested) * 0.2 > shown.time[0] + 1e-9]
        assert [by_row[row] for row in shown.rows.tolist()] == [s for s in order if s in running]
        assert shown.active.any(axis=1).all()
        assert shown.rays is shown.neighbours is shown.edges is None
