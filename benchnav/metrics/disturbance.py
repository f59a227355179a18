"""Disturbance: the time and the way that evaluated agents cost people.

A world with background navigators runs once more, without the evaluated agents, with the same
random numbers: this is the undisturbed world. It runs once for each seed, for all navigators, if
the suite has the key `undisturbed`, or if a scenario is run by its name. Its episodes are stored
under the label `undisturbed`, and verified like all others.

People who react are the agents that the evaluated navigator does not drive, also those that do not
see it: others may step out of its way into theirs. Recorded people without a driver keep to their
recording, whatever a robot does. Without people who react, or without the undisturbed world, these
metrics are not applicable.

A person is compared at the end of the record, when the evaluated agents are done. A person that
has not arrived then, with or without the robot, counts as arriving after its remaining way: the
shortest among walls and static obstacles, at its preferred speed. The same estimate in both
worlds is exact for the difference if the rest of the way is alike. A person whose attempt ended
at a collision stays where it is. Values are means over all people, near the robot or far from it,
of all evaluated agents together. Small values of both signs come from chance: in a crowd, one
evasion changes the ways of many.

A robot that crashes early disturbs people for a shorter time, so these metrics do not rank.
"""

import math

from benchnav.arrays import BoolArray
from benchnav.episode.episode import Episode
from benchnav.metrics.metric import metric
from benchnav.metrics.quantities.disturbance import Disturbance, disturbance

_HIROSE = (
    "own definition; Hirose et al. 2023 (SACSoN) for the comparison with the same people"
    " without the robot"
)


@metric(
    title="Later arrival of a person than without the evaluated agents",
    unit="s",
    better=None,
    reference=_HIROSE,
    scope="group",
    people=True,
    undisturbed=True,
)
def people_delay(episode: Episode, members: BoolArray) -> float:
    """[s] mean over people of their arrival, minus their arrival in the undisturbed world.

    NaN if the episode ends before its first decision.
    """
    found = _disturbance(episode)
    return math.nan if found is None else float(found.delay.mean())


@metric(
    title="Longer way of a person than without the evaluated agents",
    unit="m",
    better=None,
    reference=_HIROSE,
    scope="group",
    people=True,
    undisturbed=True,
)
def people_detour(episode: Episode, members: BoolArray) -> float:
    """[m] mean over people of their way to the goal, minus their way in the undisturbed world.

    NaN if the episode ends before its first decision.
    """
    found = _disturbance(episode)
    return math.nan if found is None else float(found.detour.mean())


def _disturbance(episode: Episode) -> Disturbance | None:
    """Return the disturbance of people; None if it is not defined."""
    other = episode.undisturbed() if episode.undisturbed is not None else None
    if other is None or other.failure or not len(episode.requested):
        return None
    return disturbance(episode, other) if len(episode.world.people[0]) else None
