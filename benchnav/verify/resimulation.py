"""Re-simulate stored commands to episodes."""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from benchnav.arena.world import World
from benchnav.arrays import FloatArray
from benchnav.episode.episode import Episode
from benchnav.runner.rollouts.recorder import Recorder
from benchnav.world.simulation import Simulation


def unfit(world: World, episode: Episode) -> str:
    """Return why the commands of ``episode`` cannot be stepped in ``world``; ``""`` if they can."""
    agents, steps = len(world.agents), len(episode.requested)
    if episode.requested.shape != (steps, agents, 2):
        return f"there are commands for {episode.requested.shape[1]} agents, not {agents}"
    if steps > world.clock.steps:
        return f"there are {steps} decisions; the horizon is after {world.clock.steps}"
    if not np.isfinite(episode.requested).all():
        return "requested commands must be finite"
    if episode.twist is None or episode.twist.shape != (agents,):
        return "it must state for every agent whether its commands are twists"
    for driver in np.unique(world.agents.driver):
        kinds = episode.twist[world.agents.driver == driver]
        if kinds.any() != kinds.all():
            return "agents with one navigator must have commands of one kind"
    return ""


class Resimulated(NamedTuple):
    """The result of stored commands."""

    episode: Episode
    wrong: str  # problem with the episode's length; "" if there is none
    touched: FloatArray  # (N, 2) [m] agent positions at the first touch of each event


def resimulate(pairs: Sequence[tuple[World, Episode]]) -> list[Resimulated]:
    """Return the results of the stored commands of each pair.

    All worlds share clock and rules, and no pair is `unfit`. Data that does not follow from
    commands, such as timings, is copied from the stored episode.
    """
    simulation = Simulation([world for world, _ in pairs])
    recorder = Recorder(simulation)
    stored = [episode for _, episode in pairs]
    twist = np.zeros((simulation.B, simulation.A), np.bool_)
    for b, episode in enumerate(stored):
        twist[b, : len(episode.world.agents)] = episode.twist
    recorder.record_kinds(twist)
    recorder.record_state()
    wrong = [""] * len(pairs)
    last = max(len(episode.requested) for episode in stored)
    for t in range(last + 1):
        command = np.zeros((simulation.B, simulation.A, 2))
        for b, episode in enumerate(stored):
            if t < len(episode.requested):
                command[b, : episode.requested.shape[1]] = episode.requested[t]
            elif t == len(episode.requested):
                wrong[b] = wrong[b] or _end(simulation, b, episode)
            if t < len(episode.requested) and not simulation.running[b]:
                wrong[b] = wrong[b] or f"it goes on after its end, after {t} decisions"
        recorder.restate()
        if t < last:
            executed = simulation.step(command, twist)
            recorder.record_commands(command, executed, 0.0)
            recorder.record_state()
    identities = [episode.identity for episode in stored]
    made = recorder.episodes(identities, 0.0, "", True, [()] * len(pairs))
    again = [
        replace(
            new, timings=old.timings, failure=old.failure, reproducible=old.reproducible,
            remarks=old.remarks, rehearsals=old.rehearsals,
            rehearsal_decisions=old.rehearsal_decisions, undisturbed=old.undisturbed,
        )
        for new, old in zip(made, stored, strict=True)
    ]  # fmt: skip
    touched = [simulation.touched(b) for b in range(simulation.B)]
    return [Resimulated(*of) for of in zip(again, wrong, touched, strict=True)]


def _end(simulation: Simulation, b: int, episode: Episode) -> str:
    """Handle the end of world b's record: its navigator failed, or no agent is active."""
    going_on = bool(simulation.running[b])
    if not episode.failure:
        simulation.running[b] = False
        return "it ends although an evaluated agent is active" if going_on else ""
    simulation.fail(b, np.flatnonzero(simulation.world(b).agents.evaluated))
    return "" if going_on else "its navigator failed after its end"
