"""How the attempts of an episode ended, in words."""

from collections import Counter

import numpy as np

from benchnav.arena.solid import Kind
from benchnav.arena.world import World
from benchnav.arrays import BoolArray, FloatArray
from benchnav.episode.episode import Episode, Status
from benchnav.metrics.quantities.episode_analysis import analyse
from benchnav.metrics.success import stuck


def attempt_ends(episode: Episode) -> list[str]:
    """Return for every agent how its attempt ended, in the order of the events.

    Examples: ``arrived at 6.1 s``; ``hit a wall at 3.7 s, timed out at 80 s, stuck``.
    """
    hit, contacts = _first_hits(episode), episode.contacts
    ends = _final_states(episode)
    words = []
    for agent, end in enumerate(ends):
        row = hit.get(agent)
        parts = [end] if end else []
        if row is not None:
            kind, other = int(contacts.kind[row]), int(contacts.partner[row])
            partner = partner_text(episode.world, kind, other)
            parts.insert(0, f"hit {partner} at {contacts.start[row]:.1f} s")
        words.append(", ".join(parts) or "ended by a contact without a charge")
    return words


def end_counts(episode: Episode) -> str:
    """Return how many evaluated agents ended how: ``3 arrived, 1 collided``.

    A collision of an agent that went on is in parentheses: ``4 timed out (2 collided)``.
    """
    found, hit = analyse(episode), _first_hits(episode)
    groups: Counter[str] = Counter()
    went_on: Counter[str] = Counter()
    for agent in np.flatnonzero(episode.world.agents.evaluated).tolist():
        collided = agent in hit
        if found.failed[agent]:
            group = "with a failed navigator"
        elif found.arrived[agent]:
            group = "arrived"
        elif found.active_at_end[agent]:
            group = "timed out"
        else:
            group = "collided" if collided else "ended by a contact without a charge"
        groups[group] += 1
        went_on[group] += collided and group != "collided"
    return ", ".join(
        f"{count} {group}" + (f" ({went_on[group]} collided)" if went_on[group] else "")
        for group, count in groups.items()
    )


def partner_text(world: World, kind: int, partner: int) -> str:
    """Return what an agent touched; moving obstacles have numbers from 1, agents from 0."""
    if kind == Kind.AGENT:
        return f"agent {partner}"
    if kind == Kind.DYNAMIC:
        person = world.bodies[-1 - partner].person
        return f"{'recorded person' if person else 'moving obstacle'} {-partner}"
    return "a wall" if kind == Kind.WALL else "a static obstacle"


def _first_hits(episode: Episode) -> dict[int, int]:
    """Return agent → row of its first charged contact before an arrival."""
    contacts, arrival = episode.contacts, analyse(episode).arrival
    before = np.where(np.isnan(arrival), np.inf, arrival)[contacts.agent]
    early = np.flatnonzero(contacts.charged & (contacts.start < before))
    agents, first = np.unique(contacts.agent[early], return_index=True)  # rows are in time order
    return dict(zip(agents.tolist(), early[first].tolist(), strict=True))


def _final_states(episode: Episode) -> list[str]:
    """Return the last event of every agent in words, "" if a contact ended its attempt."""
    found, end = analyse(episode), float(episode.times[-1])
    still: BoolArray = stuck(episode) == 1.0
    time: FloatArray = found.trajectories.end
    words = []
    for agent in range(len(time)):
        if found.failed[agent]:
            words.append(f"its navigator failed at {time[agent]:.1f} s")
        elif found.arrived[agent]:
            words.append(f"arrived at {found.arrival[agent]:.1f} s")
        elif found.active_at_end[agent]:
            ending = "stuck" if still[agent] else "moving"
            words.append(f"timed out at {end:.1f} s, {ending}")
        elif episode.status[-1, agent] == int(Status.WAITING):
            words.append("did not enter")
        else:
            words.append("")
    return words
