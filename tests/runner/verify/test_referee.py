"""The referee agrees with the kernels, and sees contacts that were made up or left out."""

import dataclasses

import numpy as np
import pytest

from benchnav.arena.solid import Kind
from benchnav.arena.world import ContactRule
from benchnav.verify.finding import Report
from benchnav.verify.part_check import Pair
from benchnav.verify.resimulation import resimulate
from tests.runner.verify.faulty import play, press_scene
from tests.worlds import agents, disc, limited_world, random_world, walls, world

pytest.importorskip("fcl")

from benchnav.verify.reference.fcl_check import judge
from benchnav.verify.reference.fcl_scene import Scene


def pair_of(drawn, seed=0):
    episode = play(drawn, seed)
    ((again, _, touched),) = resimulate([(drawn, episode)])
    return Pair(episode, again, touched, "here")


def judged(pair, **contacts):
    """What is said of an episode whose events are other ones."""
    changed = dataclasses.replace(pair.again.contacts, **contacts)
    report = Report()
    judge(
        dataclasses.replace(pair, again=dataclasses.replace(pair.again, contacts=changed)), report
    )
    return [finding.what for finding in report.findings]


@pytest.mark.parametrize("contact", list(ContactRule))
@pytest.mark.parametrize("unicycle", [True, False])
def test_it_agrees_with_the_kernels(contact, unicycle):
    report = Report()
    for seed in range(6):
        judge(
            pair_of(random_world(seed, contact=contact, unicycle=unicycle, steps=60), seed), report
        )
    judge(pair_of(limited_world(0, contact=contact, steps=60)), report)
    assert report.findings == []
    assert report.counts["judged events"] > 10
    assert report.counts["judged states"] > 500


def test_squeezed_and_beside_what_is_re_placed():
    pair = pair_of(press_scene())
    assert (pair.again.contacts.kind == Kind.DYNAMIC).any()
    assert pair.again.contacts.penetration.max() > 0.1
    assert judged(pair) == []


@pytest.fixture(scope="module")
def pair():
    """Somebody who runs into a pillar and a wall."""
    crew = agents([[4.0, 10.1], [12.0, 10.0]], [[19.0, 10.0], [25.0, 10.0]])
    return pair_of(world(crew, [walls(20.0), disc(Kind.STATIC, 7.0, 10.0, 1.0)], steps=40))


def test_an_event_that_was_left_out(pair):
    c = pair.again.contacts
    assert judged(pair) == []
    for n in range(len(c)):
        other = np.arange(len(c)) != n
        fields = {f.name: getattr(c, f.name)[other] for f in dataclasses.fields(c)}
        said = judged(dataclasses.replace(pair, touched=pair.touched[other]), **fields)
        # a contact without depth cannot be seen to lack; touching is no overlap
        assert not said or "there is no event" in said[0]


def test_an_event_of_who_does_not_touch(pair):
    moved = pair.touched + np.array([0.0, 2e-6])
    for place in (pair.touched + 0.01, pair.touched - 0.01, moved):
        said = judged(dataclasses.replace(pair, touched=place))
        assert all(text.endswith("then") for text in said)
    assert judged(dataclasses.replace(pair, touched=pair.touched - np.array([0.01, 0.0])))


def test_an_event_that_lasts_too_long(pair):
    end = pair.again.contacts.end.copy()
    (n,) = np.flatnonzero(pair.again.contacts.kind == Kind.STATIC)[:1]
    end[n] += 1.0
    said = judged(pair, end=end)
    assert len(said) == 1
    assert "m apart at" in said[0]


def test_an_event_that_is_less_deep_than_it_was():
    pair = pair_of(press_scene())
    said = judged(pair, penetration=0.5 * pair.again.contacts.penetration)
    assert any("they overlap by" in text for text in said)


@pytest.mark.parametrize("far", [0.3, 1e-4, 1e-7])
def test_gaps_are_exact(far):
    drawn = world(agents([4.0, 10.0], [1.0, 1.0]), [walls(20.0), disc(Kind.STATIC, 7.0, 10.0, 1.0)])
    scene, none, ahead = Scene(drawn), np.zeros(2), np.zeros(1)
    for sign in (1.0, -1.0):
        wall = scene.gap(0, np.array([0.5 + sign * far, 10.0]), ahead, ("solids", 0), none)
        pillar = scene.gap(0, np.array([7.0, 8.5 - sign * far]), ahead, ("solids", 1), none)
        assert wall == pytest.approx(sign * far, abs=1e-12)
        assert pillar == pytest.approx(sign * far, abs=1e-12)
