"""The learning agents of a batch of worlds, with one slot of the environments each."""

from dataclasses import fields, replace
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from benchnav.arrays import AnyArray, BoolArray, IntArray
from benchnav.envs.agent_batch import AgentBatch, Transition
from benchnav.envs.encoders.encoder import Float32Array
from benchnav.envs.reward import RewardTerms
from benchnav.errors import UsageError

S = TypeVar("S", bound=np.generic)


class LearnerSlots:
    """B rows of L slots over a batch; L is the largest number of learning agents in a world.

    Agents that a scenario's own drivers move have no slot. A slot is idle after its attempt until
    its row starts again, and it may be idle in a world with fewer learning agents than L. Such
    worlds use the slots in turn, so that all slots are used.
    """

    def __init__(self, batch: AgentBatch) -> None:
        self.batch = batch
        L = max(int(world.agents.evaluated.sum()) for world in batch.simulation.pool)
        self.agent: IntArray = np.full((batch.rows, L), -1)  # of the batch's A, -1: none
        self._first = np.zeros(batch.rows, np.int64)  # slot of the next world's first learner
        self._row = np.arange(batch.rows)[:, None]
        self._begun = False

    @property
    def size(self) -> int:
        """B L."""
        return self.agent.size

    @property
    def active(self) -> BoolArray:
        """(B, L) slots with an active attempt."""
        return self._of_slots(self.batch.active)

    def reset(self, worlds: IntArray | None = None) -> Float32Array:
        """Return (B, L, D) of `AgentBatch.reset`; learners then use slots from the first one on."""
        seen = self.batch.reset(worlds)
        self._first[:] = 0
        self._begun = True
        self._assign(np.arange(self.batch.rows))
        return self._of_slots(seen)

    def step(self, action: AnyArray) -> Transition:
        """Execute one decision. ``action`` is (B, L, 2) or flat, ignored for idle slots.

        The arrays of the result are (B, L, …).
        """
        if not self._begun:
            raise UsageError("An environment must be started before it is stepped: call reset().")
        action = np.asarray(action, np.float64).reshape(*self.agent.shape, 2)
        whole = np.zeros((self.batch.rows, self.batch.width, 2))
        row, slot = np.nonzero(self.agent >= 0)
        whole[row, self.agent[row, slot]] = action[row, slot]
        step = self.batch.step(whole)
        named = {f.name: self._of_slots(getattr(step.terms, f.name)) for f in fields(RewardTerms)}
        ended = {
            name: self._of_slots(getattr(step, name))
            for name in ("acted", "reward", "arrived", "touched", "timed_out", "final")
        }
        self._assign(np.flatnonzero(step.restarted.any(1)))
        return replace(
            step, terms=RewardTerms(**named), **ended,
            restarted=self._of_slots(step.restarted), observation=self._of_slots(step.observation),
        )  # fmt: skip

    def _assign(self, rows: IntArray) -> None:
        """Assign slots to the learners of the worlds that started in ``rows``."""
        L = self.agent.shape[1]
        for row in rows.tolist():
            learners = np.flatnonzero(self.batch.simulation.worlds[row].agents.evaluated)
            self.agent[row] = -1
            self.agent[row, (self._first[row] + np.arange(len(learners))) % L] = learners
            self._first[row] = (self._first[row] + len(learners)) % L

    def _of_slots(self, array: npt.NDArray[S]) -> npt.NDArray[S]:
        """Return (B, L, …) from (B, A, …); 0 for slots without an agent."""
        taken: npt.NDArray[S] = array[self._row, self.agent]
        taken[self.agent < 0] = 0
        return taken
