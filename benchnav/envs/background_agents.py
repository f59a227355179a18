"""A navigator for the agents that do not learn; it is reset when a row restarts."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchnav.arrays import BoolArray, FloatArray, IntArray
from benchnav.envs.autoreset import AutoresetSimulation
from benchnav.envs.decision import find_driven, spread
from benchnav.errors import NavigatorError
from benchnav.navigation.briefing import brief
from benchnav.navigation.command_check import CallFailed, checked
from benchnav.navigation.held_maps import HeldMaps
from benchnav.navigation.navigator import Navigator
from benchnav.navigation.observe import observe
from benchnav.navigation.plugin.configure import Spec, make, split
from benchnav.plugins import NAVIGATORS


@dataclass(frozen=True, eq=False)
class BackgroundCommands:
    """Commands of the slots that the learner does not drive, in the simulator's units."""

    mask: BoolArray  # (B, A) slots with a command
    command: FloatArray  # (B, A, 2) planar velocities [m/s] or twists [m/s, rad/s]
    twist: bool  # the commands are twists


class BackgroundNavigator:
    """A navigator that drives some agents of each row; like drivers of scenarios, it has the map.

    Args:
        spec: the navigator.
        simulation: the rows.
        at_most: largest number of agents of a row that it drives.
        blame: the first words of its error messages.

    Raises the errors of `benchnav.navigation.plugin.configure.make`.
    """

    def __init__(
        self, spec: Spec, simulation: AutoresetSimulation, at_most: int, blame: str
    ) -> None:
        self._blame = f"{blame}={split(NAVIGATORS, spec)[0]!r}"
        self._navigator: Navigator = make(NAVIGATORS, spec)
        self._needs = frozenset(map(str, self._navigator.required))
        self._simulation = simulation
        self._mine: IntArray = np.full((simulation.B, at_most), -1)  # agents, -1: padding
        self._maps = HeldMaps(simulation, "known" if self._navigator.uses_map else "unknown")

    def start(
        self, rows: IntArray, mine: Sequence[IntArray], streams: Sequence[np.random.Generator]
    ) -> None:
        """Reset the navigator for the agents ``mine`` of each of the ``rows`` that started."""
        briefings = []
        for row, agents, rng in zip(rows.tolist(), mine, streams, strict=True):
            world = self._simulation.worlds[row]
            self._mine[row] = -1
            self._mine[row, : len(agents)] = agents
            briefings.append(
                brief(
                    world.agents, agents, dt=world.clock.dt, horizon=world.clock.horizon,
                    goal_tolerance=world.rules.goal_tolerance,
                    decision_budget=world.clock.decision_budget, map=self._maps.begin(row),
                    rng=rng,
                )
            )  # fmt: skip
        if self._mine.shape[1]:
            self._navigator.reset(briefings, rows)

    def decide(self, acting: BoolArray) -> BackgroundCommands:
        """Return the commands of the driven agents among ``acting`` (B, A).

        Raises NavigatorError if the navigator returns no valid command.
        """
        active = np.empty(self._mine.shape, np.bool_)
        command = np.zeros((*acting.shape, 2))
        mask = np.zeros(acting.shape, np.bool_)
        if find_driven(self._mine, acting, active):
            try:
                maps = self._maps.now()
                seen = observe(self._simulation, self._mine, active, self._needs, maps)
                answer = checked(self._navigator.act(seen), active)
            except CallFailed as failed:
                raise NavigatorError(f"{self._blame}: {failed.reason}.") from None
            spread(self._mine, active, answer, command, mask)
        return BackgroundCommands(mask, command, self._navigator.command == "twist")
