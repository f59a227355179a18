"""How attempts ended, in words, and how many of each kind."""

from collections import Counter

import numpy as np
import pytest

import benchnav
from benchnav.metrics.attempt_ends import attempt_ends, end_counts, partner_text
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.metrics.safety import collided
from benchnav.metrics.success import stuck, timeout


@pytest.fixture(scope="module", params=["leaders/dynamic", "trap/u"])
def episode(request):
    world = benchnav.load_scenario(request.param).world(seed=7)
    return benchnav.simulate(world, "straight-line", track="unknown").record


def test_ends_are_those_of_the_metrics(episode):
    words = attempt_ends(episode)
    success, late, still = analyse(episode).success, timeout(episode), stuck(episode)
    for agent, text in enumerate(words):
        assert text.startswith("arrived at") == success[agent]
        assert ("timed out at" in text) == late[agent]
        assert text.endswith("stuck") == still[agent]
        assert text.startswith("hit ") == (collided(episode)[agent] and not success[agent])


def test_the_first_contact_is_named(episode):
    contacts, words = episode.contacts, attempt_ends(episode)
    agent = int(contacts.agent[np.flatnonzero(contacts.charged)[0]])
    row = np.flatnonzero(contacts.charged & (contacts.agent == agent))[0]
    partner = partner_text(episode.world, int(contacts.kind[row]), int(contacts.partner[row]))
    assert words[agent].startswith(f"hit {partner} at {contacts.start[row]:.1f} s")


def test_counts_are_of_every_agent_once(episode):
    found, hit = Counter(), Counter()
    late, struck = timeout(episode) == 1.0, collided(episode) == 1.0
    for agent in range(4):
        arrived = analyse(episode).success[agent]
        kind = "timed out" if late[agent] else "arrived" if arrived else "collided"
        found[kind] += 1
        hit[kind] += bool(struck[agent]) and kind == "timed out"
    expected = {
        f"{count} {kind}" + (f" ({hit[kind]} collided)" if hit[kind] else "")
        for kind, count in found.items()
    }
    assert set(end_counts(episode).split(", ")) == expected
