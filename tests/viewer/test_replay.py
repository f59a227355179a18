"""Replays: what a page holds equals what was stored."""

import json
import math
from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

import benchnav
from benchnav.api.records.episode import Episode
from benchnav.api.records.replay import Replay
from benchnav.arena.solid import Kind
from benchnav.drawing.palette import agent_color
from benchnav.episode.episode import Status
from benchnav.errors import StoreError, UsageError
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.navigation import Navigator, Need
from benchnav.testing.zoo import zoo
from benchnav.viewer.replay.clearance import clearance
from benchnav.viewer.replay.packing import packed, unpacked
from benchnav.viewer.replay.page import replay_page
from benchnav.viewer.replay.scene import events, interesting, scene
from benchnav.viewer.replay.senses import sensed
from tests.world.test_footprint import core, fixed_core


@pytest.fixture(scope="module")
def episode():
    """Four agents among static and moving obstacles; one of them stands still until the end."""
    world = benchnav.load_scenario("leaders/dynamic").world(seed=7)
    return benchnav.simulate(world, "orca", track="unknown", salt="00").record


@given(
    arrays(
        np.float64, array_shapes(min_dims=1, max_dims=3, max_side=7),
        elements=st.floats(-1e5, 1e5, width=32),
    )
)  # fmt: skip
def test_packed_arrays_come_back(array):
    assert np.allclose(unpacked(packed(array, 0.001)), array, atol=0.0005 + 1e-9, rtol=0)


def test_a_scene_holds_the_stored_motion(episode):
    content = json.loads(json.dumps(scene(episode, interesting(episode)), allow_nan=False))
    for name in ("position", "body_position"):
        stored = getattr(episode, name)
        assert np.allclose(unpacked(content[name]), stored, atol=0.0005 + 1e-9)
    turned = unpacked(content["heading"]) - episode.heading
    assert np.abs(np.exp(1j * turned) - 1.0).max() < 0.001
    assert (unpacked(content["status"]) == episode.status).all()
    assert len(content["solids"]) == len(episode.world.solids)


def test_agents_have_the_colours_of_figures(episode):
    content = scene(episode, interesting(episode))
    found = [content["colours"][number] for number in content["agents"]["colour"]]
    assert found == [agent_color(episode.world, agent) for agent in range(4)]
    assert len(set(found)) == 4


def test_failed_agents_are_chosen_first(episode):
    success = analyse(episode).success
    chosen = interesting(episode)
    assert not success[chosen[0]]
    assert success[chosen].tolist() == sorted(success[chosen].tolist())


def test_the_smallest_clearance_is_that_of_the_metric(episode):
    expected = analyse(episode).encounters.clearance
    last = analyse(episode).trajectories.last
    for agent in range(len(expected)):
        least = clearance(episode, agent)[: last[agent] + 1].min()
        # the metric also looks between states, where an agent moves at most 0.4 m
        assert expected[agent] - 1e-9 <= least <= expected[agent] + 0.4


def test_the_clearance_of_a_body_that_is_not_a_disc_is_that_of_its_shape():
    world = benchnav.load_scenario("robots/doorway").world(seed=1)
    record = benchnav.simulate(world, "orca", track="unknown", salt="00").record
    agents, solids = record.world.agents, [fixed_core(solid) for solid in record.world.solids]
    gone = analyse(record).trajectories.leaves
    for t in range(0, len(record.position), 7):
        here = np.flatnonzero(t < gone)
        places = zip(here, record.position[t, here], record.heading[t, here], strict=True)
        bodies = {a: core(agents, a, place, heading) for a, place, heading in places}
        for agent, (shape, radius) in bodies.items():
            others = [*solids, *(bodies[j] for j in here if j != agent)]
            least = min(shape.distance(other) - radius - r for other, r in others)
            assert clearance(record, int(agent))[t] == pytest.approx(least, abs=1e-6)


def test_senses_are_those_of_the_navigator(episode):
    """A slow twin for rays that hit nothing else: their end is within an obstacle's reach."""
    agents = interesting(episode)
    found = sensed(episode, agents)
    active = episode.status[:, agents] == int(Status.ACTIVE)
    assert (found.distance[~active] == episode.world.sensing.rays.range).all()
    hits = found.kind == int(Kind.AGENT)
    assert (hits & active[..., None]).any()
    for t, n, ray in np.argwhere(hits & active[..., None]):
        angle = episode.heading[t, agents[n]] + found.angle[ray]
        end = episode.position[t, agents[n]]
        end = end + found.distance[t, n, ray] * np.array([math.cos(angle), math.sin(angle)])
        others = np.delete(np.arange(len(episode.world.agents)), agents[n])
        radius = episode.world.agents.radius
        gap = np.linalg.norm(episode.position[t, others] - end, axis=1) - radius[others]
        assert abs(gap.min() - radius[agents[n]]) < 1e-6  # thick rays stop at contact


def test_neighbours_are_named(episode):
    agents = interesting(episode)
    found = sensed(episode, agents).neighbours
    count, bodies = len(episode.world.agents), len(episode.world.bodies)
    assert ((found >= -1) & (found < count + bodies)).all()
    for n, agent in enumerate(agents):
        assert not (found[:, n] == agent).any()
        for row in found[:, n]:
            held = row[row >= 0]
            assert len(set(held)) == len(held)


def test_events_tell_every_contact_once(episode):
    contacts = episode.contacts
    both = {(int(a), int(p), float(s)) for a, k, p, s in zip(
        contacts.agent, contacts.kind, contacts.partner, contacts.start, strict=True
    ) if k == int(Kind.AGENT)}  # fmt: skip
    once = {(min(a, p), max(a, p), round(s, 3)) for a, p, s in both}
    shown = [e for e in events(episode) if e["kind"] == "contact" and e["with"] == "agent"]
    found = {
        (min(e["agent"], e["partner"]), max(e["agent"], e["partner"]), e["time"]) for e in shown
    }
    assert found == once
    assert len(shown) == len(once)
    times = [event["time"] for event in events(episode)]
    assert times == sorted(times)
    arrived = {e["agent"] for e in events(episode) if e["kind"] == "arrival"}
    assert arrived == set(np.flatnonzero(np.isfinite(episode.arrival)).tolist())
    assert [e["kind"] for e in events(episode)][-1] == "timeout"


def test_an_old_episode_without_kinds_of_commands_is_shown_without_senses(episode):
    assert scene(replace(episode, twist=None), interesting(episode))["senses"] is None


def test_text_of_strangers_is_escaped(episode):
    name = "</script><script>alert(1)</script>"
    odd = replace(episode, identity=replace(episode.identity, navigator=name), failure="<b>")
    page = replay_page([scene(odd, interesting(odd))])
    assert "<script>alert" not in page
    assert "<b>" not in page


def test_a_page_asks_for_nothing_and_is_small(episode):
    page = replay_page([scene(episode, interesting(episode))])
    assert "http://" not in page
    assert "https://" not in page
    assert len(page) <= 150_000


def test_the_link_back_is_escaped(episode):
    content = [scene(episode, interesting(episode))]
    assert 'data-back=""' in replay_page(content)
    assert 'data-back="../a.html?b=1&amp;c"' in replay_page(content, back="../a.html?b=1&c")


def test_each_episode_is_named_if_worlds_differ(episode):
    other = replace(episode, identity=replace(episode.identity, seed=8, navigator="other"))
    assert repr(Replay([episode, other], agents=[])) == (
        "Replay(orca/leaders/dynamic@1/unknown/7, other/leaders/dynamic@1/unknown/8)"
    )
    page = Replay([episode, other], agents=[]).html
    assert "<title>orca in leaders/dynamic@1, seed 7; other in leaders/dynamic@1, seed 8<" in page


def test_a_page_shows_one_to_nine(episode):
    assert Replay([episode] * 9, agents=[]).html
    for count in (0, 10):
        with pytest.raises(UsageError, match="1 to 9"):
            Replay([episode] * count)


def test_saving(episode, tmp_path):
    handle = Episode(episode).replay(agents=[0])
    assert handle.save(tmp_path / "a.html").read_text(encoding="utf-8") == handle.html
    assert "<iframe srcdoc=" in handle._repr_html_()
    with pytest.raises(UsageError, match="must end in"):
        handle.save(tmp_path / "a.mp5")
    assert handle.save(tmp_path / "new" / "folder" / "a.html").is_file()
    with pytest.raises(StoreError, match="must be writable"):
        handle.save(tmp_path / "a.html" / "b.html")
    with pytest.raises(UsageError, match="0 to 3"):
        Episode(episode).replay(agents=[4])


@pytest.mark.parametrize("suffix", [".html", ".png", ".gif", ".mp4", ".rrd", ".mcap"])
def test_an_episode_without_a_decision_is_shown(tmp_path, suffix):
    """A navigator that fails in `reset` leaves one state."""

    class Fails(Navigator):
        def reset(self, briefings, rows):
            raise RuntimeError("no")

        def act(self, observation):
            raise AssertionError

    for module in {".mp4": ["imageio_ffmpeg"], ".mcap": ["mcap_protobuf"], ".rrd": ["rerun"]}.get(
        suffix, ["matplotlib"]
    ):
        pytest.importorskip(module)
    world = benchnav.load_scenario("leaders/dynamic").world(seed=7)
    failed = benchnav.simulate(world, Fails())
    assert failed.failure
    assert len(failed.record.position) == 1
    assert failed.replay().save(tmp_path / f"a{suffix}").stat().st_size > 0


class Witness(Navigator):
    """Records what it perceives while it drives to its goal."""

    needs = frozenset({Need.RAYS, Need.NEIGHBOURS, Need.EDGES})
    seen: ClassVar = []

    def act(self, observation):
        self.seen.append(observation)
        return observation.goal - observation.position


def in_body(vector, heading):
    """Vectors (…, 2) in the frame of a body."""
    c, s = np.cos(heading), np.sin(heading)
    x, y = vector[..., 0], vector[..., 1]
    return np.stack([c * x + s * y, c * y - s * x], axis=-1)


def test_senses_of_a_noisy_episode_are_those_of_the_navigator():
    world = benchnav.load_scenario("leaders/dynamic").world(seed=3)
    Witness.seen.clear()
    played = benchnav.simulate(world, Witness, perception="noisy", salt="07")
    record = played.record
    agents = np.flatnonzero(record.world.agents.evaluated)[1:]
    found = sensed(record, agents, played.origin().assignment)
    assert found.noisy
    astray = 0  # places where nothing is
    for t, seen in enumerate(Witness.seen):
        for n, agent in enumerate(agents):
            if not seen.active[0, agent]:
                continue
            np.testing.assert_array_equal(found.distance[t, n], seen.rays.distance[0, agent])
            count = seen.neighbours.count[0, agent]
            own, body = seen.position[0, agent], record.position[t, agent]
            np.testing.assert_allclose(
                in_body(found.places[t, n, :count] - body, record.heading[t, agent]),
                in_body(seen.neighbours.position[0, agent, :count] - own, seen.heading[0, agent]),
                atol=1e-9,
            )
            truth = np.concatenate([record.position[t], record.body_position[t]])
            apart = np.linalg.norm(found.places[t, n, :count, None] - truth[None], axis=-1)
            astray += int((apart.min(axis=1, initial=9.0) > 0.1).sum())
    assert astray > 0


def test_a_replay_says_whether_its_readings_have_noise():
    world = benchnav.load_scenario("leaders/dynamic").world(seed=3)
    played = benchnav.simulate(world, "orca", perception="noisy", salt="07")
    agents = interesting(played.record)
    noisy = scene(played.record, agents, played.origin)["senses"]
    assert noisy["noisy"]
    assert "places" in noisy
    for origin in (None, lambda: "packs are not trusted"):
        exact = scene(played.record, agents, origin)["senses"]
        assert not exact["noisy"]
        assert "places" not in exact


def test_an_agent_is_no_object_before_it_enters():
    late = zoo()["late"]
    content = scene(late, interesting(late))
    entered = (late.status != int(Status.WAITING)).argmax(axis=0)
    assert content["agents"]["enters"] == [0, int(entered[1]), len(late.position)]
    assert content["agents"]["end"][2] == "did not enter"
    gap = clearance(late, 0)
    apart = np.linalg.norm(late.position[:, 1] - late.position[:, 0], axis=-1) - 0.6
    wall = 8.0 - np.abs(late.position[:, 0, 1]) - 0.3
    later = np.arange(len(gap)) >= entered[1]
    assert np.allclose(gap[~later], np.minimum(wall, 12.0 + late.position[:, 0, 0] - 0.3)[~later])
    assert (gap <= apart + 1e-9)[late.status[:, 1] == int(Status.ACTIVE)].all()
