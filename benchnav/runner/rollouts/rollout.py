"""Runs one navigator in many worlds, in lockstep."""

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from benchnav.arena.noise import Noise
from benchnav.arena.sensing import Sensing
from benchnav.arena.world import Clock, Rules, World
from benchnav.episode.episode import Episode, Identity
from benchnav.errors import BrokenPluginError, MissingExtraError, NavigatorError
from benchnav.isolation.isolated import Isolated
from benchnav.isolation.subprocess_host import PROCESS
from benchnav.navigation.command_check import CallFailed, exception_text
from benchnav.navigation.navigator import Navigator
from benchnav.navigation.plugin.configure import Spec, make, split
from benchnav.navigation.plugin.trace import notes, trace
from benchnav.navigation.rehearsal import Rehearsal
from benchnav.plugins import NAVIGATORS
from benchnav.runner.execute.call_timer import calling
from benchnav.runner.rollouts.navigator_driver import PROPERTIES, Driver
from benchnav.runner.rollouts.recorder import Recorder
from benchnav.runner.rollouts.seeding import generator, noise_key, place
from benchnav.runner.rollouts.tamper_guard import Guard
from benchnav.scenario.condition import EXACT, NOISY
from benchnav.world.simulation import Simulation

MAX_WORLDS = 256  # of a batch: larger batches are hardly faster and need more memory
MAX_BYTES = 256 << 20  # of recorded states of a batch that runs to its horizon
_BYTES = 72  # recorded per agent and decision


@dataclass(frozen=True)
class Assignment:
    """The navigator, the scenario, the knowledge and the perception of a rollout."""

    scenario: str  # "leaders/dynamic@1"
    scenario_hash: str
    split: str
    track: str
    label: str  # of the navigator in the suite
    navigator: Spec
    background: tuple[Spec, ...] = ()  # navigators of the scenario's other teams
    salt: str = ""  # of the run; no navigator receives it
    navigator_hash: str = ""  # of its configuration, distributions and mode
    source_hash: str = ""  # of its code and data files
    rehearsals: int = 0  # that the navigator asks for
    leader: Spec | None = None  # the navigator of the leaders in rehearsals
    rehearsal: int = 0  # k: this is the k-th rehearsal; 0: the scored episode
    # of the senses of the navigator, and of its leaders in rehearsals; None: perception `exact`
    noise: Noise | None = None
    isolated: bool = False  # whether the evaluated navigator runs in its own process
    # of the undisturbed world: ``navigator`` is the first background navigator
    undisturbed: bool = False

    @property
    def perception(self) -> str:
        """The perception: exact or noisy."""
        return EXACT if self.noise is None else NOISY

    @property
    def cell(self) -> tuple[str, ...]:
        """The key of an isolated process, which serves one role in one cell."""
        role = "rehearsal" if self.rehearsal else "episode"
        condition = self.track, self.perception
        return self.scenario, self.scenario_hash, self.split, *condition, self.label, role

    def identity(self, seed: int) -> Identity:
        """Return the identity of the episode with this seed."""
        return Identity(
            self.scenario, self.scenario_hash, self.split, seed, self.track, self.label,
            self.navigator_hash, self.rehearsal, self.source_hash, self.perception,
        )  # fmt: skip


Seeded = tuple[int, World]
Grants = Mapping[int, tuple[Rehearsal, ...]]  # by seed


def rollout(
    assignment: Assignment,
    worlds: Sequence[Seeded],
    charge: str = "",
    grants: Grants = MappingProxyType({}),
) -> Iterator[list[Episode]]:
    """Yield the episodes of all worlds, batch by batch; the batching does not affect them.

    The order of the rows does not depend on the order of the seeds.

    If a call fails for a batch, its episodes start again in smaller batches with new navigators,
    until the worlds that fail on their own are found: only these fail.

    Args:
        assignment: the navigator, the scenario, the knowledge and the perception.
        worlds: (seed, world) pairs.
        charge: a reason for which every episode fails without running (its navigator
            killed the process, for example); "" runs them.
        grants: the rehearsals that the evaluated navigator receives, by seed.
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
    """Yield batches of consecutive worlds with equal terms that fit into memory together."""
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
    """Return smaller batches, in one of which the failure occurs again.

    Each suspect runs in its own batch and all others in halves, so a world restarts at most
    log2(B) + 1 times, even if every world fails at a different time.
    """
    suspects = set() if failed.suspects is None else set(failed.suspects.tolist())
    singles = [[world] for b, world in enumerate(batch) if b in suspects]
    others = [world for b, world in enumerate(batch) if b not in suspects]
    half = len(others) // 2
    return [part for part in (others[:half], others[half:], *singles) if part]


def _lockstep(
    assignment: Assignment, batch: list[Seeded], charge: str, grants: Grants, traceback: str = ""
) -> list[Episode]:
    """Return the episodes of a batch; with a ``charge`` they fail without running."""
    simulation = Simulation([world for _, world in batch])
    recorder = Recorder(simulation)
    recorder.record_state()
    planning, failure, drivers = 0.0, charge, list[Driver]()
    if charge:
        _charge(simulation, recorder)
    else:
        granted_rehearsals = [grants.get(seed, ()) for seed, _ in batch]
        try:
            drivers = drivers_of(assignment, simulation, granted_rehearsals)
            planning = drive(assignment, drivers, recorder, [seed for seed, _ in batch])
        except NavigatorError as error:  # its process cannot start, so every world fails
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
    return [replace(e, traceback=traceback) for e in episodes] if traceback else episodes


def drive(
    assignment: Assignment,
    drivers: list[Driver],
    recorder: Recorder,
    seeds: Sequence[int],
    decisions: int | None = None,
) -> float:
    """Run new drivers until no world runs, or for ``decisions`` decisions.

    Returns the duration [s] of the evaluated navigator's reset. Raises CallFailed if a navigator
    fails.
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
    """Return drivers of the evaluated navigator, then of the background ones.

    Background navigators are on the known track, and perceive without error.

    ``rehearsals`` (B,) of each world are given to the evaluated navigator. Raises CallFailed if a
    navigator cannot be made.
    """
    cell = assignment.cell if assignment.isolated else ()
    guard = None if cell else Guard()  # before code of the navigator is imported
    chosen, track = _made(assignment.navigator, "", cell), assignment.track
    drivers = [
        Driver(
            chosen, simulation, 0, track, rehearsals=rehearsals, guard=guard,
            noise=assignment.noise,
        )
    ]  # fmt: skip
    for which, spec in enumerate(assignment.background, start=1):
        blame = f"the scenario's background navigator {split(NAVIGATORS, spec)[0]!r}: "
        drivers.append(Driver(_made(spec, blame), simulation, which, "known", blame))
    return [driver for driver in drivers if driver.chosen.size]


def _made(spec: Spec, blame: str, cell: tuple[str, ...] = ()) -> Navigator:
    """Return a navigator; with ``cell`` it runs in the process of that key."""
    apart = cell and split(NAVIGATORS, spec)[0] != PROCESS
    try:
        with calling("__init__"):
            navigator: Navigator = Isolated(spec, cell) if apart else make(NAVIGATORS, spec)
            for name in PROPERTIES:  # the first access starts an isolated process
                getattr(navigator, name)
    except BrokenPluginError as error:
        raise CallFailed(f"{blame}{error}", traceback=notes(error) or trace(error)) from error
    except (MissingExtraError, NavigatorError):
        raise
    except (Exception, SystemExit) as error:
        with calling("__init__"):
            reason = f"{blame}__init__ raised {exception_text(error)}"
        raise CallFailed(reason, traceback=trace(error)) from error
    return navigator


def _reset(assignment: Assignment, drivers: list[Driver], seeds: Sequence[int]) -> float:
    """Brief all navigators. Return the duration [s] of the evaluated navigator's reset."""
    about = (assignment.salt, assignment.scenario_hash, assignment.split)
    which = assignment.rehearsal
    noisy = assignment.noise is not None
    keys = np.array([noise_key(*about, seed, which) for seed in seeds]) if noisy else None
    shift = int(assignment.undisturbed)  # people draw the same numbers as beside the robot
    seconds = [
        d.reset([generator(*about, seed, d.which + shift, which) for seed in seeds], keys)
        for d in drivers
    ]
    return seconds[0]


def _run(
    simulation: Simulation, drivers: list[Driver], recorder: Recorder, decisions: int | None
) -> None:
    """Sense, act, step and record until no world runs, or for ``decisions`` decisions."""
    twist = np.zeros(simulation.present.shape, np.bool_)
    for driver in drivers:
        driver.mark_twists(twist)
    recorder.record_kinds(twist)
    clock = simulation.world(0).clock
    dt, last = clock.dt, clock.steps if decisions is None else min(decisions, clock.steps)
    for step in range(last):  # a limit even if a navigator replaced the code that ends an episode
        if not simulation.running.any():
            break
        served = int(simulation.running.sum())
        command = np.zeros_like(simulation.position)
        seconds = [driver.act(command, step * dt) for driver in drivers]
        executed = simulation.step(command, twist)
        recorder.record_commands(command, executed, seconds[0] / served)
        recorder.record_state()
