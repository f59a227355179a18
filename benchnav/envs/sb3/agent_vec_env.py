"""Stable-Baselines3's VecEnv: every learning agent of every world is one environment."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from operator import index
from typing import Any, cast

import numpy as np
from stable_baselines3.common.vec_env import VecEnv

from benchnav.arrays import AnyArray, BoolArray, ByteArray
from benchnav.envs.agent_batch import AgentBatch, Correction, Transition
from benchnav.envs.encoders.encoder import Float32Array
from benchnav.envs.episode_stats import Tally
from benchnav.envs.factory import check_render_mode
from benchnav.envs.gym.spaces import action_space, last_seen, observation_space, terms
from benchnav.envs.learner_slots import LearnerSlots
from benchnav.envs.rendering import FPS, RGB_ARRAY, Renderer
from benchnav.envs.reward import RewardWeights
from benchnav.errors import UsageError


@dataclass(frozen=True, eq=False)
class SlotTransition:
    """The results of one decision of all slots, (S,) each; entries of idle slots are 0."""

    observation: Float32Array  # (S, D) after restarts
    reward: Float32Array  # scaled
    over: BoolArray  # the attempt ended
    timed_out: BoolArray  # the attempt ended at the horizon
    restarted: BoolArray  # the observation is the first of another attempt
    final: Float32Array  # (S, D) before restarts


class AgentVecEnv(VecEnv):
    """The learning agents of one or more batches, one slot each, one batch after the other.

    A slot is done only when its attempt ends. It is idle from then until its row starts again:
    it observes zeros and gets no reward. `acted` and ``infos[i]["idle"]`` distinguish decisions
    from idle transitions, so that a learner can ignore the latter; `AttemptMonitor` and
    `AttemptPPO` do.
    """

    render_mode: str | None

    def __init__(self, batches: Sequence[AgentBatch], render_mode: str | None = None) -> None:
        """Take batches, which are reset by `reset`.

        Args:
            batches: of the same encoder.
            render_mode: "rgb_array": `render` returns one picture of all worlds; None.

        Raises NoRenderingError for another mode.
        """
        check_render_mode(render_mode, (RGB_ARRAY,))
        self.render_mode = render_mode
        self.batches = tuple(batches)
        self._renderers = tuple(Renderer(batch.simulation) for batch in self.batches)
        self._begun = False
        self._slots = tuple(LearnerSlots(batch) for batch in self.batches)
        self.tally = Tally()
        size = sum(slots.size for slots in self._slots)
        self.acted: BoolArray = np.zeros(size, np.bool_)
        self.woke: BoolArray = np.zeros(size, np.bool_)  # idle before the last step, not after
        self._action: Any = None
        space: Any = observation_space(self.batches[0].encoder)
        super().__init__(size, space, cast(Any, action_space()))
        self.metadata: dict[str, Any] = {**self.metadata, "render_fps": FPS}

    def enter(self, weights: RewardWeights, seed: int, correct: Correction | None = None) -> None:
        """Set reward weights, seed of worlds and correction of commands, from the next reset on."""
        self.tally = Tally()
        for batch in self.batches:
            batch.weights, batch.correct = weights, correct
        self.seed(seed)

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        """Seed the order of worlds, and all other randomness, from the next reset on.

        Returns one seed per slot, as Stable-Baselines3 does; None draws one. Slots share worlds, so
        only the first seed is used. Raises UsageError for a seed below 0.
        """
        if seed is not None and index(seed) < 0:
            raise UsageError(f"The seed must be 0 or more. Got {seed} instead.")
        return super().seed(None if seed is None else index(seed))

    def reset(self) -> Any:
        seed = self._seeds[0]
        if seed is not None:
            for k, batch in enumerate(self.batches):
                batch.reseed(np.random.default_rng([seed, k]))
        self._begun = True
        self._reset_seeds()
        self._reset_options()
        observation = np.concatenate([_flat(slots.reset()) for slots in self._slots])
        self.acted[:] = self.woke[:] = False
        active = np.concatenate([slots.active.reshape(-1) for slots in self._slots])
        self.reset_infos = [{"idle": not bool(here)} for here in active]
        return observation

    @property
    def active(self) -> BoolArray:
        """(S,) slots with an active attempt."""
        return _joined([slots.active for slots in self._slots])

    def decide(self, actions: AnyArray) -> SlotTransition:
        """Execute one decision, ``actions`` (S, 2) in [-1, 1], without the dicts of `step`."""
        steps = self._execute(actions)
        flags = [[step.over for step in steps], [step.timed_out for step in steps],
                 [step.restarted for step in steps]]  # fmt: skip
        return SlotTransition(
            np.concatenate([_flat(step.observation) for step in steps]),
            _joined([step.reward for step in steps]).astype(np.float32),
            *map(_joined, flags),
            np.concatenate([_flat(step.final) for step in steps]),
        )

    def _execute(self, actions: AnyArray) -> list[Transition]:
        steps, first = [], 0
        for slots in self._slots:
            steps.append(slots.step(actions[first : first + slots.size]))
            first += slots.size
        for step in steps:
            self.tally.add(step)
        self.acted = _joined([step.acted for step in steps])
        self.woke = _joined([step.restarted & ~step.acted for step in steps])
        return steps

    def step_async(self, actions: Any) -> None:
        self._action = actions

    def step_wait(self) -> Any:
        steps = self._execute(self._action)
        observation = np.concatenate([_flat(step.observation) for step in steps])
        reward = _joined([step.reward for step in steps]).astype(np.float32)
        done = _joined([step.over for step in steps])
        infos: list[dict[str, Any]] = [{"idle": not bool(acted)} for acted in self.acted]
        first = 0
        for step in steps:
            _describe_ends(step, infos[first : first + step.acted.size])
            first += step.acted.size
        return observation, reward, done, infos

    def get_images(self) -> Sequence[ByteArray | None]:
        """Return a picture (H, W, 3) of each world, from which `render` makes one.

        Raises UsageError before the first reset.
        """
        if not self._begun:
            raise UsageError("There is no world to draw: call reset() before render().")
        return [
            renderer.frame(row)
            for batch, renderer in zip(self.batches, self._renderers, strict=True)
            for row in range(batch.rows)
        ]

    def close(self) -> None:
        pass

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        return [getattr(self, attr_name)] * len(self._chosen(indices))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        setattr(self, attr_name, value)

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> Any:
        return [getattr(self, method_name)(*args, **kwargs)] * len(self._chosen(indices))

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        return [False] * len(self._chosen(indices))

    def _chosen(self, indices: int | Iterable[int] | None) -> list[int]:
        return list(self._get_indices(indices))


def _flat(array: Any) -> Any:
    return array.reshape(-1, array.shape[-1])


def _joined(arrays: Sequence[Any]) -> Any:
    return np.concatenate([array.reshape(-1) for array in arrays])


def _describe_ends(step: Transition, infos: list[dict[str, Any]]) -> None:
    """Add the outcomes of ended attempts to ``infos``, one per slot."""
    last, named = last_seen(step), terms(step)
    for b, a in np.argwhere(step.over):
        infos[b * step.acted.shape[1] + a] |= {
            "is_success": bool(step.arrived[b, a]),
            "TimeLimit.truncated": bool(step.timed_out[b, a]),
            "terminal_observation": last[b, a],
            "terms": {name: float(term[b, a]) for name, term in named.items()},
        }
