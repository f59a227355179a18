"""Runs one navigator in many worlds, in lockstep."""

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from benchnav.arena.sensing import Sensing
from benchnav.arena.world import Clock, Rules, World
from benchnav.episode.episode import Episode, Identity
from benchnav.errors import BrokenPluginError, MissingExtraError, NavigatorError
from benchnav.isolation.isolated import Isolated
from benchnav.isolation.subprocess_host import PROCESS
from benchnav.navigation.command_check import CallFailed, said
from benchnav.navigation.navigator import Navigator
from benchnav.navigation.plugin.configure import Spec, make, split
from benchnav.navigation.plugin.trace import notes, trace
from benchnav.navigation.rehearsal import Rehearsal
from benchnav.plugins import NAVIGATORS
from benchnav.runner.execute.call_timer import calling
from benchnav.runner.rollouts.navigator_driver import PROPERTIES, Driver
from benchnav.runner.rollouts.recorder import Recorder
from benchnav.runner.rollouts.seeding import generator, place
from benchnav.runner.rollouts.tamper_guard import Guard
from benchnav.world.simulation import Simulation

MAX_WORLDS = 64  # of a batch: more gains little speed and holds more in memory
MAX_BYTES = 256 << 20  # of recorded states of a batch that runs to its horizon
_BYTES = 72  # recorded per agent and decision


@dataclass(frozen=True)
class Assignment:
    """Who runs where, and with which knowledge."""

    scenario: str  # "leaders/dynamic@1"
    scenario_hash: str
    split: str
    track: str
    label: str  # of the navigator in the suite
    navigator: Spec
    background: tuple[Spec, ...] = ()  # navigators of the scenario's other teams
    salt: str = ""  # of the run; no navigator is handed it
    navigator_hash: str = ""  # of its configuration, distributions and mode
    source_hash: str = ""  # of its code and data files
    rehearsals: int = 0  # that the navigator asks for
    leader: Spec | None = None  # who drives the leaders in them
    rehearsal: int = 0  # k: this is the k-th of them
    isolated: bool = False  # whether the evaluated navigator is put into a process of its own

    @property
    def cell(self) -> tuple[str, ...]:
        """What an isolated navigator's process may serve: one role in one cell."""
        role = "rehearsal" if self.rehearsal else "episode"
        return self.scenario, self.scenario_hash, self.split, self.track, self.label, role

    def identity(self, seed: int) -> Identity:
        """Of the episode with this seed."""
        return Identity(
            self.scenario, self.scenario_hash, self.split, seed, self.track, self.label,
            self.navigator_hash, self.rehearsal, self.source_hash,
        )  # fmt: skip


Seeded = tuple[int, World]
Grants = Mapping[int, tuple[Rehearsal, ...]]  # by seed


def rollout(
    assignment: Assignment,
    worlds: Sequence[Seeded],
    charge: str = "",
    grants: Grants = MappingProxyType({}),
) -> Iterator[list[Episode]]:
    """Every world's episode, batch by batch; the batching changes no state and no command.

    Rows are given in an order that tells nothing about the seeds.

    A call that fails for a batch is tried again from the start of the episodes with
    fewer worlds, so that no state of a navigator is touched twice, until the worlds
    that fail alone are found: only they are charged.

    Args:
        assignment: who runs where.
        worlds: (seed, world) pairs.
        charge: a reason for which every world is charged without running (its
            navigator killed the process, say); "" runs them.
        grants: the rehearsals that the evaluated navigator is told of, by seed.
    """
    about = (assignment.salt, assignment.scenario_hash, assignment.split)
    pending = deque(batches(sorted(worlds, key=lambda world: place(*about, world[0]))))
    while pending:
        batch = pending.popleft()
        try:
            yield _lockstep(assignment, batch, charge, grants)
        except CallFailed as failed:
            pending.extendleft(reversed(_split(batch, failed)))


def batches(worlds: Sequence[Seeded]) -> Iterator[list[Seeded]]:
    """Consecutive worlds that share their terms and fit into memory together when stepped."""
    batch: list[Seeded] = []
    size = 0
    for seed, world in worlds:
        cost = len(world.agents) * world.clock.steps * _BYTES
        alike = batch and _terms(batch[0][1]) == _terms(world)
        if batch and (not alike or len(batch) == MAX_WORLDS or size + cost > MAX_BYTES):
            yield batch
            batch, size = [], 0
        batch.append((seed, world))
        size += cost
    if batch:
        yield batch


def _terms(world: World) -> tuple[Clock, Rules, Sensing]:
    return world.clock, world.rules, world.sensing


def _split(batch: list[Seeded], failed: CallFailed) -> list[list[Seeded]]:
    """Smaller batches, in one of which the failure shows again.

    Suspects run alone and all others in halves, so that a world starts again no more
    than log2(B) + 1 times, also where every world fails at a time of its own.
    """
    guilty = set() if failed.suspects is None else set(failed.suspects.tolist())
    alone = [[world] for b, world in enumerate(batch) if b in guilty]
    others = [world for b, world in enumerate(batch) if b not in guilty]
    half = len(others) // 2
    return [part for part in (others[:half], others[half:], *alone) if part]


def _lockstep(
    assignment: Assignment, batch: list[Seeded], charge: str, grants: Grants, traceback: str = ""
) -> list[Episode]:
    """The episodes of a batch; with a ``charge``, which has a ``traceback``, nothing is run."""
    simulation = Simulation([world for _, world in batch])
    recorder = Recorder(simulation)
    recorder.record_state()
    planning, failure, drivers = 0.0, charge, list[Driver]()
    if charge:
        _charge(simulation, recorder)
    else:
        told = [grants.get(seed, ()) for seed, _ in batch]
        try:
            drivers = drivers_of(assignment, simulation, told)
            planning = drive(assignment, drivers, recorder, [seed for seed, _ in batch])
        except NavigatorError as error:  # its process does not start, in whatever world
            return _lockstep(assignment, batch, str(error), grants, notes(error))
        except CallFailed as failed:
            if len(batch) > 1:
                raise
            failure, traceback = failed.reason, failed.traceback
            _charge(simulation, recorder)
    reproducible = all(driver.reproducible for driver in drivers)
    remarks = [drivers[0].remarks(row) if drivers else () for row in range(len(batch))]
    identities = [assignment.identity(seed) for seed, _ in batch]
    episodes = recorder.episodes(identities, planning, failure, reproducible, remarks)
    return [replace(episode, traceback=traceback) for episode in episodes]


def drive(
    assignment: Assignment,
    drivers: list[Driver],
    recorder: Recorder,
    seeds: Sequence[int],
    decisions: int | None = None,
) -> float:
    """Run fresh drivers until no world runs, or for so many decisions.

    Returns the seconds of the evaluated navigator's reset. Raises CallFailed where a
    navigator fails.
    """
    planning = _reset(assignment, drivers, seeds)
    _run(recorder.simulation, drivers, recorder, decisions)
    return planning


def _charge(simulation: Simulation, recorder: Recorder) -> None:
    for b in range(simulation.B):
        simulation.fail(b, np.flatnonzero(simulation.world(b).agents.evaluated))
    recorder.restate()


def drivers_of(
    assignment: Assignment,
    simulation: Simulation,
    rehearsals: Sequence[tuple[Rehearsal, ...]] = (),
) -> list[Driver]:
    """The evaluated navigator, then the background ones, which know the scenario's map.

    ``rehearsals`` (B,) are what the first is told of, none where there are none. Raises
    CallFailed where one cannot be made.
    """
    cell = assignment.cell if assignment.isolated else ()
    guard = None if cell else Guard()  # before anything of it is imported
    chosen, track = _made(assignment.navigator, "", cell), assignment.track
    drivers = [Driver(chosen, simulation, 0, track, rehearsals=rehearsals, guard=guard)]
    for which, spec in enumerate(assignment.background, start=1):
        blame = f"the scenario's background navigator {split(NAVIGATORS, spec)[0]!r}: "
        drivers.append(Driver(_made(spec, blame), simulation, which, "known", blame))
    return [driver for driver in drivers if driver.chosen.size]


def _made(spec: Spec, blame: str, cell: tuple[str, ...] = ()) -> Navigator:
    """The navigator; one that is isolated is hosted by the process of ``cell``."""
    apart = cell and split(NAVIGATORS, spec)[0] != PROCESS
    try:
        with calling("__init__"):
            navigator: Navigator = Isolated(spec, cell) if apart else make(NAVIGATORS, spec)
            for name in PROPERTIES:  # for which a process of its own is started
                getattr(navigator, name)
    except BrokenPluginError as error:
        raise CallFailed(f"{blame}{error}", traceback=notes(error) or trace(error)) from error
    except (MissingExtraError, NavigatorError):
        raise
    except (Exception, SystemExit) as error:
        with calling("__init__"):
            reason = f"{blame}__init__ raised {said(error)}"
        raise CallFailed(reason, traceback=trace(error)) from error
    return navigator


def _reset(assignment: Assignment, drivers: list[Driver], seeds: Sequence[int]) -> float:
    """Brief everybody. Returns the seconds that the evaluated navigator took."""
    about = (assignment.salt, assignment.scenario_hash, assignment.split)
    which = assignment.rehearsal
    seconds = [
        d.reset([generator(*about, seed, d.which, which) for seed in seeds]) for d in drivers
    ]
    return seconds[0]


def _run(
    simulation: Simulation, drivers: list[Driver], recorder: Recorder, decisions: int | None
) -> None:
    """Sense, act, step and record until no world runs, or for so many decisions."""
    twist = np.zeros(simulation.present.shape, np.bool_)
    for driver in drivers:
        driver.mark_twists(twist)
    recorder.record_kinds(twist)
    clock = simulation.world(0).clock
    dt, last = clock.dt, clock.steps if decisions is None else min(decisions, clock.steps)
    for step in range(last):  # also where somebody replaced what ends an episode
        if not simulation.running.any():
            break
        served = int(simulation.running.sum())
        command = np.zeros_like(simulation.position)
        seconds = [driver.act(command, step * dt) for driver in drivers]
        executed = simulation.step(command, twist)
        recorder.record_commands(command, executed, seconds[0] / served)
        recorder.record_state()
