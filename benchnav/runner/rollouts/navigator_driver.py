"""One navigator in a batch: its briefings, its observations and its commands."""

from collections.abc import Callable, Sequence
from time import perf_counter
from typing import Any, get_args

import numpy as np

from benchnav.arena.noise import Noise
from benchnav.arena.world import World
from benchnav.arrays import AnyArray, BoolArray, FloatArray, IntArray
from benchnav.errors import MissingExtraError
from benchnav.navigation.briefing import Briefing, brief
from benchnav.navigation.command_check import CallFailed, checked, exception_text, remarks_of
from benchnav.navigation.held_maps import HeldMaps
from benchnav.navigation.navigator import CommandKind, Navigator, Need
from benchnav.navigation.observation import Observation
from benchnav.navigation.observe import deciding, observe
from benchnav.navigation.plugin.trace import trace
from benchnav.navigation.rehearsal import Rehearsal, copied
from benchnav.runner.execute.call_timer import Call, calling
from benchnav.runner.rollouts.tamper_guard import Guard
from benchnav.sensors.noise.noisy_senses import NoisySenses
from benchnav.world.command import give_commands
from benchnav.world.simulation import Simulation

PROPERTIES: dict[str, Callable[[Any], Any]] = {  # name of a property → its validation
    "required": lambda value: frozenset(map(Need, value)),
    "command": lambda value: _one_of(value, get_args(CommandKind)),
    "reproducible": bool,
}


class Driver:
    """A navigator and the agents that it drives in each world of a batch.

    All arrays that the navigator receives are copies or read-only.
    """

    def __init__(
        self,
        navigator: Navigator,
        simulation: Simulation,
        which: int,
        track: str,
        blame: str = "",
        rehearsals: Sequence[tuple[Rehearsal, ...]] = (),
        guard: Guard | None = None,
        noise: Noise | None = None,
    ) -> None:
        self.navigator = navigator
        self.simulation = simulation
        self.which = which
        self.track = track
        self._blame = blame  # the start of its failure reasons
        self._guard = guard  # of the code of benchnav, if both share a process
        worlds = simulation.worlds
        self._rehearsals = rehearsals or [()] * len(worlds)
        self.chosen = _chosen(worlds, which)  # (B, An) agent index, -1: padding
        self._senses = NoisySenses(simulation, self.chosen, noise) if noise is not None else None
        with calling("__init__"):
            properties = [_property_of(navigator, name, blame) for name in PROPERTIES]
        needs, self._command, self.reproducible = properties
        self._needs = frozenset(needs)
        self._maps = HeldMaps(simulation, track)

    def reset(
        self, generators: Sequence[np.random.Generator], noise_keys: AnyArray | None = None
    ) -> float:
        """Brief the navigator for all worlds. Return the duration of its call [s].

        ``noise_keys`` (B, 2) of uint64 are those of `NoisySenses`. Raises CallFailed if the call
        raises.
        """
        worlds = self.simulation.worlds
        if self._senses is not None and noise_keys is not None:
            self._senses.begin(np.arange(len(worlds)), noise_keys)
        briefings = [
            self._briefing(b, world, rng)
            for b, (world, rng) in enumerate(zip(worlds, generators, strict=True))
        ]
        rows = np.arange(len(worlds))
        began = perf_counter()
        try:
            with calling("reset"):
                self.navigator.reset(briefings, rows)
        except CallFailed as failed:
            reason = f"{self._blame}{failed.reason}"
            raise CallFailed(reason, failed.suspects, failed.traceback) from None
        except MissingExtraError:
            raise  # a missing package is no failure of the navigator
        except (Exception, SystemExit) as error:
            reason, traceback = _raised("reset", error)
            raise CallFailed(self._blame + reason, traceback=traceback) from error
        seconds = perf_counter() - began
        self._require_intact(self._blame)
        return seconds

    def mark_twists(self, twist: BoolArray) -> None:
        """Set ``twist`` (B, A) for its agents if it returns twists."""
        world, agent = np.nonzero(self.chosen >= 0)
        twist[world, self.chosen[world, agent]] = self._command == "twist"

    def act(self, command: FloatArray, time: float) -> float:
        """Write its commands for all running worlds into ``command`` (B, A, 2).

        Args:
            command: receives the commands of the agents that it drives.
            time: [s] the current time, equal in all running worlds.

        Returns the duration of its call [s]. Raises CallFailed if the call raises or returns
        invalid commands.
        """
        observation = self._observe()
        # Copies, because a plugin may change its observation.
        active, rows = observation.active.copy(), observation.rows.copy()
        began = perf_counter()
        try:
            with calling("act", time):
                answer = self.navigator.act(observation)
                seconds = perf_counter() - began
                commands = checked(answer, active)
            self._require_intact()
        except CallFailed as failed:
            suspects = None if failed.suspects is None else rows[failed.suspects]
            raise CallFailed(self._at(failed.reason, time), suspects, failed.traceback) from None
        except MissingExtraError:
            raise  # a missing package is no failure of the navigator
        except (Exception, SystemExit) as error:
            reason, traceback = _raised("act", error, time)
            raise CallFailed(self._at(reason, time), traceback=traceback) from error
        if self._senses is not None and self._command == "velocity":
            commands = self._senses.in_world_frame(rows, commands)
        give_commands(0, len(rows), rows, self.chosen, active, commands, command)
        return seconds

    def remarks(self, row: int) -> tuple[str, ...]:
        """Return the remarks on the world in ``row``, or the exception if the call raises."""
        try:
            with calling("remarks"):
                return tuple(remarks_of(self.navigator.remarks(row)))
        except (Exception, SystemExit) as error:
            return (_raised("remarks", error)[0],)

    def _require_intact(self, blame: str = "") -> None:
        replaced = self._guard.replaced() if self._guard is not None else ""
        if replaced:
            raise CallFailed(f"{blame}it replaced {replaced}, which is no part of it")

    def _at(self, reason: str, time: float) -> str:
        return f"{self._blame}{reason} at t = {time:g} s"

    def _observe(self) -> Observation:
        simulation = self.simulation
        active = deciding(simulation, self.chosen)
        maps = self._maps.now()
        observation = observe(simulation, self.chosen, active, self._needs, maps, self._senses)
        if simulation.running.all():
            return observation
        return observation.select(np.flatnonzero(simulation.running))

    def _briefing(self, b: int, world: World, rng: np.random.Generator) -> Briefing:
        clock = world.clock
        return brief(
            world.agents, self.chosen[b][self.chosen[b] >= 0], dt=clock.dt, horizon=clock.horizon,
            goal_tolerance=world.rules.goal_tolerance, decision_budget=clock.decision_budget,
            map=self._maps.begin(b), rng=rng, rehearsals=tuple(map(copied, self._rehearsals[b])),
        )  # fmt: skip


def _one_of(value: Any, choices: Sequence[str]) -> str:
    if value not in choices:
        raise ValueError(f"it must be {' or '.join(choices)}")
    return str(value)


def _property_of(navigator: Navigator, name: str, blame: str) -> Any:
    """Return a property of the navigator. Raises CallFailed if it raises or is invalid."""
    try:
        return PROPERTIES[name](getattr(navigator, name))
    except MissingExtraError:
        raise
    except (Exception, SystemExit) as error:
        raise CallFailed(
            f"{blame}{name} raised {exception_text(error)}", traceback=trace(error)
        ) from error


def _raised(call: Call, error: BaseException, time: float = 0.0) -> tuple[str, str]:
    """Return (reason, traceback) of an exception; its text may run code of the plugin."""
    with calling(call, time):
        return f"{call} raised {exception_text(error)}", trace(error)


def _chosen(worlds: Sequence[World], which: int) -> IntArray:
    mine = [np.flatnonzero(world.agents.driver == which) for world in worlds]
    chosen = np.full((len(worlds), max(map(len, mine))), -1)
    for b, agents in enumerate(mine):
        chosen[b, : len(agents)] = agents
    return chosen
