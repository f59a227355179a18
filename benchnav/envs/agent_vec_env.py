"""Stable-Baselines3's VecEnv: every agent of every world is one environment."""

from collections.abc import Iterable, Sequence
from dataclasses import fields
from typing import Any, cast

import numpy as np
from stable_baselines3.common.vec_env import VecEnv

from benchnav.arrays import BoolArray
from benchnav.envs.agent_batch import AgentBatch, Correction, Transition
from benchnav.envs.reward import RewardTerms, RewardWeights
from benchnav.envs.spaces import action_space, observation_space
from benchnav.envs.tally import Tally


class AgentVecEnv(VecEnv):
    """Slots of one or more batches, one after the other.

    A slot that idles until its row starts again observes zeros, is paid nothing, and is
    done with that idle stretch when the row starts again; `acted` says which transitions
    of the last step were real, so that a learner can leave the others out.
    """

    render_mode: str | None = None

    def __init__(self, batches: Sequence[AgentBatch]) -> None:
        self.batches = tuple(batches)
        slots = sum(batch.rows * batch.width for batch in self.batches)
        self.tally = Tally()
        self.acted: BoolArray = np.zeros(slots, np.bool_)
        self._action: Any = None
        space: Any = observation_space(self.batches[0].encoder)
        super().__init__(slots, space, cast(Any, action_space()))

    def enter(self, weights: RewardWeights, seed: int, correct: Correction | None = None) -> None:
        """From the next reset on, pay by ``weights``, draw worlds in the order of ``seed``, and
        execute what ``correct`` makes of commands.
        """
        self.tally = Tally()
        for k, batch in enumerate(self.batches):
            batch.weights, batch.correct = weights, correct
            batch.reseed(np.random.default_rng([seed, k]))

    def reset(self) -> Any:
        return np.concatenate([_flat(batch.reset()) for batch in self.batches])

    def step_async(self, actions: Any) -> None:
        self._action = actions

    def step_wait(self) -> Any:
        steps, first = [], 0
        for batch in self.batches:
            slots = batch.rows * batch.width
            part = self._action[first : first + slots]
            steps.append(batch.step(part.reshape(batch.rows, batch.width, 2)))
            first += slots
        self.acted = np.concatenate([step.acted.reshape(-1) for step in steps])
        for step in steps:
            self.tally.add(step)
        done = np.concatenate([(step.over | step.restarted).reshape(-1) for step in steps])
        reward = np.concatenate([step.reward.reshape(-1) for step in steps]).astype(np.float32)
        observation = np.concatenate([_flat(step.observation) for step in steps])
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        first = 0
        for step in steps:
            _tell(step, infos, first)
            first += step.acted.size
        return observation, reward, done, infos

    def close(self) -> None:
        pass

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        return [getattr(self, attr_name)] * len(self._slots(indices))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        setattr(self, attr_name, value)

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> Any:
        return [getattr(self, method_name)(*args, **kwargs)] * len(self._slots(indices))

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        return [False] * len(self._slots(indices))

    def _slots(self, indices: int | Iterable[int] | None) -> list[int]:
        return list(self._get_indices(indices))


def _flat(array: Any) -> Any:
    return array.reshape(-1, array.shape[-1])


def _tell(step: Transition, infos: list[dict[str, Any]], first: int) -> None:
    """What happened to the attempts that ended."""
    width = step.acted.shape[1]
    for b, a in np.argwhere(step.over | (step.restarted & ~step.acted)):
        info = infos[first + b * width + a]
        info["idle"] = not bool(step.acted[b, a])
        if info["idle"]:
            continue
        info["is_success"] = bool(step.arrived[b, a])
        info["TimeLimit.truncated"] = bool(step.timed_out[b, a])
        info["terminal_observation"] = step.final[b, a]
        info["terms"] = {
            f.name: float(getattr(step.terms, f.name)[b, a]) for f in fields(RewardTerms)
        }
