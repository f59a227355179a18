"""The recording of a batch of worlds, which is split into episodes at the end."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from benchnav.arrays import AnyArray, BoolArray, FloatArray
from benchnav.episode.episode import Episode, Identity, Timings
from benchnav.store.parts.digest import digest
from benchnav.world.simulation import Simulation

_STATE = ("position", "heading", "status", "body_position")


class Recorder:
    """Records states at every decision time, and the commands between them."""

    def __init__(self, simulation: Simulation) -> None:
        self.simulation = simulation
        self._state: dict[str, list[AnyArray]] = {name: [] for name in _STATE}
        self._requested: list[FloatArray] = []
        self._executed: list[FloatArray] = []
        self._seconds: list[float] = []
        self._twist = np.zeros((simulation.B, simulation.A), np.bool_)

    @property
    def seconds(self) -> FloatArray:
        """(T,) [s] duration per world of every decision."""
        return np.array(self._seconds)

    def record_state(self) -> None:
        """Record the current state."""
        for name, kept in self._state.items():
            kept.append(getattr(self.simulation, name).copy())

    def record_kinds(self, twist: BoolArray) -> None:
        """Record the agents whose commands are twists (B, A)."""
        self._twist = twist.copy()

    def record_commands(self, requested: FloatArray, executed: FloatArray, seconds: float) -> None:
        """Record the requested and executed commands of a decision, and its seconds per world."""
        self._requested.append(requested)
        self._executed.append(executed)
        self._seconds.append(seconds)

    def restate(self) -> None:
        """Replace the last state, after a change of the agents without a time step."""
        for name, kept in self._state.items():
            kept[-1] = getattr(self.simulation, name).copy()

    def episodes(
        self,
        identities: Sequence[Identity],
        planning: float,
        failure: str,
        reproducible: bool,
        remarks: Sequence[tuple[str, ...]],
    ) -> list[Episode]:
        """Return one episode per world, in the order of the worlds.

        Args:
            identities: (B,) of the worlds.
            planning: [s] of all resets together, which is divided equally among the worlds.
            failure: why the navigator failed (then B is 1); "" if it did not.
            reproducible: whether no command depends on a clock.
            remarks: (B,) of the navigator on each world.
        """
        state = {name: np.stack(kept) for name, kept in self._state.items()}
        shape = (0, *self.simulation.position.shape)
        requested = np.stack(self._requested) if self._requested else np.zeros(shape)
        executed = np.stack(self._executed) if self._executed else np.zeros(shape)
        share, seconds = planning / len(identities), self.seconds
        episodes = []
        for b, identity in enumerate(identities):
            world, steps = self.simulation.world(b), int(self.simulation.steps_done[b])
            agents, bodies = len(world.agents), len(world.bodies)
            episode = Episode(
                identity=identity,
                world=world,
                position=state["position"][: steps + 1, b, :agents].copy(),
                heading=state["heading"][: steps + 1, b, :agents].copy(),
                status=state["status"][: steps + 1, b, :agents].copy(),
                body_position=state["body_position"][: steps + 1, b, :bodies].copy(),
                requested=requested[:steps, b, :agents].copy(),
                executed=executed[:steps, b, :agents].copy(),
                arrival=self.simulation.arrival[b, :agents].copy(),
                contacts=self.simulation.contacts(b),
                timings=Timings(seconds[:steps], share, len(identities)),
                failure=failure,
                reproducible=reproducible,
                remarks=remarks[b],
                twist=self._twist[b, :agents].copy(),
            )
            episodes.append(replace(episode, digest=digest(episode)))
        return episodes
