"""Rehearsals are made by the runner, kept, charged, and change nothing that is not granted."""

import sys
from collections import Counter

import numpy as np
import pytest

from benchnav.arena.agents import Role
from benchnav.errors import ScenarioError
from benchnav.navigation.navigator import Navigator
from benchnav.runner.plan import task as task_module
from benchnav.runner.plan.suite import Selection, load_suite
from benchnav.runner.rollouts.seeding import generator, phases
from benchnav.runner.run import run_suite
from benchnav.store.parts.part import REHEARSALS_FILE, SEAL
from benchnav.store.runs.manifest import load_manifest
from benchnav.store.runs.reading import read_episodes, read_rehearsals, read_results
from benchnav.world.simulation import Simulation

SCENARIO = """
name: tiny/group
title: A leader and its followers, and a group without a leader
bounds: [-8, -8, 8, 8]
static:
  - shape: {type: disc, radius: 0.5}
    count: 2
    region: {type: rectangle, bounds: [-2, -2, 2, 2]}
dynamic:
  - shape: {type: box, width: 0.5}
    count: 2
    region: {type: rectangle, bounds: [-3, -3, 3, 3]}
    law: {type: back-and-forth, length: 2, speed: 0.7}
teams:
  - name: led
    role: leader
    radius: 0.3
    max_speed: 1.5
    start: {type: region, region: {type: rectangle, bounds: [-7, -7, -4, -4]}}
    goal: {type: points, points: [[6, 6]]}
  - name: led
    role: follower
    count: 3
    radius: 0.2
    max_speed: 1
    start: {type: region, region: {type: rectangle, bounds: [-7, -7, -4, -4]}, separation: 0.1}
    goal: {type: region, region: {type: rectangle, bounds: [4, 4, 7, 7]}}
  - name: unled
    role: follower
    count: 3
    radius: 0.2
    max_speed: 1
    start: {type: region, region: {type: rectangle, bounds: [4, -7, 7, -4]}, separation: 0.1}
    goal: {type: region, region: {type: rectangle, bounds: [-7, 4, -4, 7]}}
  - name: passers
    count: 1
    radius: 0.3
    max_speed: 1
    driver: straight-line
    start: {type: points, points: [[0, -7]]}
    goal: {type: points, points: [[0, 7]]}
clock: {dt: 0.2, substeps: 2, horizon: 14}
rules: {contact: slide}
"""

NAVIGATORS = '''
import os

import numpy as np

from benchnav.navigation.navigator import Navigator, PluginConfig
from pydantic import Field

SEEN = []


class Config(PluginConfig):
    rehearsal: int = Field(2, description="how many")
    leader: str = Field("orca", description="who leads")


class Told(Navigator):
    """Keeps its briefings; goes straight."""

    Config = Config

    @property
    def rehearsal(self):
        return self.config.rehearsal

    @property
    def leader(self):
        return self.config.leader

    def reset(self, briefings, rows):
        SEEN.extend(briefings)

    def act(self, observation):
        way = observation.goal - observation.position
        return way / np.maximum(np.hypot(way[..., 0], way[..., 1]), 1.0)[..., None]


class Vandal(Told):
    def reset(self, briefings, rows):
        for briefing in briefings:
            for rehearsal in briefing.rehearsals:
                rehearsal.position[...] = 7.0
                rehearsal.arrival[...] = 0.0


class Lost(Navigator):
    """Leads, and fails where it starts far west, in the second rehearsal."""

    def reset(self, briefings, rows):
        self.bad = {int(r): b.start[0, 0] < -5.5 for r, b in zip(rows, briefings)}

    def act(self, observation):
        for b, row in enumerate(observation.rows):
            if self.bad[int(row)] and observation.time[b] > 0.5:
                self.fail()
        return np.full((*observation.active.shape, 2), 0.3)

    def fail(self):
        raise ValueError("lost the way")


class Deadly(Lost):
    def fail(self):
        os._exit(7)


class Endless(Told):
    """Rehearses without saying who leads."""

    @property
    def leader(self):
        return None


class Slow(Navigator):
    """Never arrives."""

    def act(self, observation):
        return np.zeros((*observation.active.shape, 2))
'''
SALT = "5a" * 16


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("rehearsal")
    (folder / "rehearsing_navigators.py").write_text(NAVIGATORS)
    (folder / "group.yaml").write_text(SCENARIO)
    sys.path.insert(0, str(folder))
    yield folder
    sys.path.remove(str(folder))


@pytest.fixture
def suite(folder, tmp_path):
    """Entries as YAML → a suite of four seeds."""

    def suite(*entries, seeds="4"):
        path = tmp_path / "suite.yaml"
        listed = "\n".join(f"  - {entry}" for entry in entries)
        path.write_text(f"name: small\nscenarios: [{folder / 'group.yaml'}]\nnavigators:\n{listed}")
        return load_suite(str(path), Selection(salt=SALT, seeds=seeds))

    return suite


def told(parameters=""):
    return "{type: 'rehearsing_navigators:Told', label: told" + parameters + "}"


def digests(run):
    found = {}
    for episode in (*read_episodes(run), *read_rehearsals(run)):
        who = episode.identity
        found[who.navigator, who.seed, who.rehearsal] = episode.digest
    return found


def test_leaders_rehearse_alone_among_the_same_walls_with_other_phases(suite, tmp_path):
    run_suite(suite(told()), tmp_path / "r", workers=0)
    scored = {e.identity.seed: e.world for e in read_episodes(tmp_path / "r")}
    rehearsals = list(read_rehearsals(tmp_path / "r"))
    assert [(e.identity.seed, e.identity.rehearsal) for e in rehearsals] == [
        (seed, k) for seed in range(4) for k in (1, 2)
    ]
    phases = Counter()
    for episode in rehearsals:
        world, before = episode.world, scored[episode.identity.seed]
        assert len(world.agents) == 3  # the leader, one of those without, the passer-by
        assert world.agents.evaluated.tolist() == [True, True, False]
        assert (world.agents.role[:2] == int(Role.LEADER)).all()
        assert world.agents.start[0].tolist() == before.agents.start[0].tolist()
        assert world.agents.start[1].tolist() in before.agents.start[4:7].tolist()
        for one, other in zip(world.solids, before.solids, strict=True):
            assert one.capsules.tolist() == other.capsules.tolist()
        for one, other in zip(world.bodies, before.bodies, strict=True):
            assert one.law.points.tolist() == other.law.points.tolist()
            assert one.law.times.tolist() == other.law.times.tolist()
            assert one.law.phase != other.law.phase
            phases[one.law.phase] += 1
    assert set(phases.values()) == {1}


def test_the_briefing_says_what_the_leaders_did_and_the_episode_what_it_cost(suite, tmp_path):
    import rehearsing_navigators

    rehearsing_navigators.SEEN.clear()
    run_suite(suite(told(), seeds="1"), tmp_path / "r", workers=0)
    (episode,) = read_episodes(tmp_path / "r")
    made = list(read_rehearsals(tmp_path / "r"))
    briefing = rehearsing_navigators.SEEN[0]
    assert len(briefing.rehearsals) == 2
    for rehearsal, stored in zip(briefing.rehearsals, made, strict=True):
        assert rehearsal.position.tolist() == stored.position[:, :2].tolist()
        assert briefing.start[rehearsal.agent].tolist() == stored.world.agents.start[:2].tolist()
        assert np.array_equal(rehearsal.arrival, stored.arrival[:2], equal_nan=True)
        for k in range(2):
            way = rehearsal.trajectory(k)
            assert way[0].tolist() == briefing.start[rehearsal.agent[k]].tolist()
            if not np.isnan(rehearsal.arrival[k]):
                goal = briefing.goal[rehearsal.agent[k]]
                assert np.hypot(*(way[-1] - goal)) < briefing.goal_tolerance + 1.5 * 0.2
    expected = sum(int((e.status[:-1, :2] == 0).sum()) for e in made)
    assert (episode.rehearsals, episode.rehearsal_decisions) == (2, expected)
    assert episode.timings.rehearsal == pytest.approx(
        sum(e.timings.planning + e.timings.decision.sum() for e in made)
    )
    rows = read_results(tmp_path / "r").to_pylist()
    assert {(r["rehearsal"], r["rehearsal_decisions"]) for r in rows} == {(2, expected)}
    assert {r["rehearsal_seconds"] for r in rows} == {episode.timings.rehearsal}


def test_a_stranger_can_verify_a_rehearsal(suite, tmp_path):
    run_suite(suite(told(), seeds="2"), tmp_path / "r", workers=0)
    for episode in read_rehearsals(tmp_path / "r"):
        simulation = Simulation([episode.world])
        twist = np.zeros((1, len(episode.world.agents)), np.bool_)
        for step, command in enumerate(episode.requested):
            assert simulation.position[0].tobytes() == episode.position[step].tobytes()
            simulation.step(command[None], twist)
        assert simulation.position[0].tobytes() == episode.position[-1].tobytes()


def test_no_number_of_workers_and_no_interruption_changes_a_bit(suite, tmp_path, monkeypatch):
    asked = suite(told(), "orca")
    run_suite(asked, tmp_path / "here", workers=0)
    whole = digests(tmp_path / "here")
    assert len(whole) == 2 * 4 + 4 * 2
    monkeypatch.setattr(task_module, "CHUNK", 1)
    run_suite(asked, tmp_path / "there", workers=2)
    assert digests(tmp_path / "there") == whole
    for seal in sorted((tmp_path / "there").glob(f"parts/*/*{SEAL}"))[::2]:
        seal.unlink()
    run_suite(asked, tmp_path / "there", workers=0)
    assert digests(tmp_path / "there") == whole


def test_who_asks_for_none_gets_none_and_is_not_disturbed(suite, tmp_path):
    run_suite(suite("orca"), tmp_path / "alone", workers=0)
    run_suite(suite(told(), "orca"), tmp_path / "beside", workers=0)
    alone, beside = digests(tmp_path / "alone"), digests(tmp_path / "beside")
    assert {key: beside[key] for key in alone} == alone
    assert not list((tmp_path / "alone").glob(f"parts/*/*{REHEARSALS_FILE}"))
    assert {e.rehearsals for e in read_episodes(tmp_path / "alone")} == {0}


def test_what_is_handed_over_is_a_copy(suite, tmp_path):
    vandal = "{type: 'rehearsing_navigators:Vandal', label: told}"
    run_suite(suite(told()), tmp_path / "kind", workers=0)
    run_suite(suite(vandal), tmp_path / "vandal", workers=0)
    assert digests(tmp_path / "kind") == digests(tmp_path / "vandal")


@pytest.mark.parametrize("workers", [0, 1])
def test_a_leader_that_fails_is_charged_to_the_entry_with_its_reason(suite, tmp_path, workers):
    lost = told(", leader: 'rehearsing_navigators:Lost'")
    summary = run_suite(suite(lost, seeds="8"), tmp_path / "r", workers=workers)
    episodes = list(read_episodes(tmp_path / "r"))
    bad = [e.world.agents.start[0, 0] < -5.5 for e in episodes]
    assert 0 < sum(bad) < 8
    ((_, reason),) = summary.failures
    assert reason.startswith(
        "in rehearsal 1, 'rehearsing_navigators:Lost' that led: act raised ValueError: lost the way"
        " (rehearsing_navigators.py:"
    )
    assert reason.endswith(") at t = 0.6 s")
    assert all(("lost the way" in e.traceback) == b for e, b in zip(episodes, bad, strict=True))
    assert [e.failure for e in episodes] == [reason if b else "" for b in bad]
    assert summary.failures == {("told", reason): sum(bad)}
    assert {e.rehearsals for e in episodes} == {2}  # failed ones rank with the others
    per_seed = Counter(e.identity.seed for e in read_rehearsals(tmp_path / "r"))
    assert [per_seed[e.identity.seed] for e in episodes] == [1 if b else 2 for b in bad]


def test_a_leader_that_kills_its_process_costs_its_own_worlds_alone(suite, tmp_path):
    deadly = told(", leader: 'rehearsing_navigators:Deadly'")
    run_suite(suite(deadly, seeds="3"), tmp_path / "r", workers=1)
    for episode in read_episodes(tmp_path / "r"):
        dead = episode.world.agents.start[0, 0] < -5.5
        assert bool(episode.failure) == dead
        assert episode.rehearsals == 2


def test_a_leader_that_never_succeeds_is_told_in_the_log(suite, tmp_path):
    slow = told(", leader: 'rehearsing_navigators:Slow'")
    asked = suite(slow, seeds="2")
    summary = run_suite(asked, tmp_path / "r", workers=0)
    assert summary.unled == {("told", "tiny/group@1", team): 2 for team in ("led", "unled")}


def test_a_cell_is_n_a_where_its_leader_cannot_work(suite, tmp_path):
    asked = suite(told(", leader: ompl-pure"))
    (cell,) = [c for c in asked.jobs() if c.track == "known"]
    assert cell.reason == ""
    unknown = load_suite(str(tmp_path / "suite.yaml"), Selection(tracks=("unknown",)))
    assert [c.reason for c in unknown.jobs()] == ["its leaders' ompl-pure needs a map"]


def test_who_leads_must_be_named_and_must_not_rehearse(suite):
    with pytest.raises(ScenarioError, match="must name the leaders' navigator"):
        suite("{type: 'rehearsing_navigators:Endless'}")
    with pytest.raises(ScenarioError, match="must not ask for rehearsals itself"):
        suite(told(", leader: 'rehearsing_navigators:Told'"))


def test_the_manifest_says_who_led_and_the_hash_depends_on_it(suite, tmp_path):
    run_suite(suite(told(), seeds="1"), tmp_path / "r", workers=0)
    (entry,) = load_manifest(tmp_path / "r").suite["navigators"]
    assert (entry["rehearsal"], entry["leader"]["label"]) == (2, "orca")
    assert entry["leader"]["config"]["time_horizon"] == 5.0
    hashes = {
        suite(told(f", leader: {name}")).contestants[0].hash for name in ("orca", "straight-line")
    }
    assert len(hashes) == 2


def test_every_rehearsal_has_streams_of_its_own():
    about = (SALT, "a" * 16, "test", 3)
    drawn = [generator(*about, 0, k).random() for k in range(5)]
    drawn += [phases(*about, k).random() for k in range(1, 5)]
    assert len(set(drawn)) == len(drawn)
    assert drawn[0] == generator(*about, 0).random()


def test_a_navigator_asks_for_no_rehearsal_unless_it_says_so():
    class Plain(Navigator):
        def act(self, observation):
            return observation.goal

    assert (Plain().rehearsal, Plain().leader, Plain().remarks(0)) == (0, None, ())
