"""Simulate one episode in memory, without a run folder."""

from dataclasses import replace
from functools import cache, partial

from benchnav.api.execution.navigators import NavigatorLike, navigator_spec
from benchnav.api.records.episode import Episode
from benchnav.api.records.world import World
from benchnav.episode.episode import Episode as Record
from benchnav.errors import UsageError
from benchnav.generation.undisturbed_world import undisturbed_world
from benchnav.processes.main_module import stop_import_of_main
from benchnav.runner.plan.contestant import ContestantFactory
from benchnav.runner.plan.job import Job, undisturbed_job
from benchnav.runner.rollouts.rehearsal import perform
from benchnav.runner.rollouts.rollout import rollout
from benchnav.runner.rollouts.seeding import check_salt, draw_salt
from benchnav.scenario.condition import EXACT, require_perception, require_track
from benchnav.verify.own_map import Production


def simulate(
    world: World,
    navigator: NavigatorLike,
    *,
    track: str = "known",
    perception: str = EXACT,
    salt: str | None = None,
) -> Episode:
    """Run a navigator in a world, in this process, and return the episode.

    Nothing is stored. Where the navigator raises an exception, the episode says so in
    `Episode.failure`, and its agents count as failed. Where people react, the undisturbed world
    runs when it is first needed, by `Episode.undisturbed` or a metric of disturbance.

    Args:
        world: from `Scenario.world`.
        navigator: a name, ``{"type": name, …parameters}``, a class, an instance or a function.
        track: known, stale, partial or unknown: which map the navigator gets.
        perception: exact or noisy: how well the navigator senses.
        salt: of the navigator's randomness, in hexadecimal digits; None: a new one each time.

    Raises UsageError where the navigator cannot work in this scenario and track, for an unknown
    track or perception, and PluginError where it cannot be made.
    """
    stop_import_of_main()
    require_track(track)
    require_perception(perception)
    scenario = world.scenario.record
    factory = ContestantFactory((world.record.sensing,), isolate=False, here=True)
    contestant = factory.create(navigator_spec(navigator), "navigator")
    job = Job(scenario, world.split, track, contestant, perception=perception)
    if job.reason:
        raise UsageError(f"{contestant.label!r} cannot be run here: {job.reason}.")
    assignment = replace(job.assignment, salt=_salt(salt))
    (batch,) = perform(assignment, [(world.seed, world.record)])
    made = Production(assignment, tuple(batch[0].rehearsed.grant))
    record = batch[0].episode
    if scenario.drivers:
        record = replace(record, undisturbed=cache(partial(_undisturbed, world, assignment.salt)))
    return Episode(record, lambda: made)


def _undisturbed(world: World, salt: str) -> Record:
    """Run the world without its evaluated agents, with the random numbers of the same salt."""
    job = undisturbed_job(world.scenario.record, world.split)
    people = undisturbed_world(world.record)
    ((episode,),) = rollout(replace(job.assignment, salt=salt), [(world.seed, people)])
    return episode


def _salt(text: str | None) -> str:
    try:
        if text is not None:
            check_salt(text.lower())
    except ValueError as error:
        raise UsageError(f"The salt {error}.") from None
    return draw_salt() if text is None else text.lower()
