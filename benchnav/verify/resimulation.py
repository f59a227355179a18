"""Stored commands → the episodes that they lead to."""

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
    """Why the commands of ``episode`` cannot be stepped in ``world``; ``""`` where they can."""
    agents, steps = len(world.agents), len(episode.requested)
    if episode.requested.shape != (steps, agents, 2):
        return f"there are commands for {episode.requested.shape[1]} agents, not {agents}"
    if steps > world.clock.steps:
        return f"there are {steps} decisions; the horizon is after {world.clock.steps}"
    if not np.isfinite(episode.requested).all():
        return "requested commands must be finite"
    if episode.twist is None or episode.twist.shape != (agents,):
        return "it must say of every agent whether its commands are twists"
    for driver in np.unique(world.agents.driver):
        kinds = episode.twist[world.agents.driver == driver]
        if kinds.any() != kinds.all():
            return "agents with one navigator must have commands of one kind"
    return ""


class Resimulated(NamedTuple):
    """What stored commands lead to."""

    episode: Episode
    wrong: str  # with its length; "" if nothing is
    touched: FloatArray  # (N, 2) [m] where the agent of each event was when it first touched


def resimulate(pairs: Sequence[tuple[World, Episode]]) -> list[Resimulated]:
    """What the stored commands of each pair lead to.

    All worlds share clock and rules, and no pair is `unfit`. What commands cannot tell,
    such as timings, is taken from what is stored.
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
            rehearsal_decisions=old.rehearsal_decisions,
        )
        for new, old in zip(made, stored, strict=True)
    ]  # fmt: skip
    touched = [simulation.touched(b) for b in range(simulation.B)]
    return [Resimulated(*of) for of in zip(again, wrong, touched, strict=True)]


def _end(simulation: Simulation, b: int, episode: Episode) -> str:
    """The record of world b ends here: its navigator failed, or nobody is left to go on."""
    going_on = bool(simulation.running[b])
    if not episode.failure:
        simulation.running[b] = False
        return "it ends though an evaluated agent is on its way" if going_on else ""
    simulation.fail(b, np.flatnonzero(simulation.world(b).agents.evaluated))
    return "" if going_on else "its navigator failed after its end"
