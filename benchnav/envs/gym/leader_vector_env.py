"""Gymnasium's VectorEnv: every learning agent of every row is a sub-environment."""

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from benchnav.arrays import BoolArray, ByteArray, FloatArray
from benchnav.envs.agent_batch import Autoreset, Transition
from benchnav.envs.encoders.encoder import Float32Array
from benchnav.envs.factory import Reward, check_render_mode, make_batch
from benchnav.envs.gym.spaces import action_space, last_seen, observation_space, terms
from benchnav.envs.learner_slots import LearnerSlots
from benchnav.envs.rendering import FPS, RGB_ARRAY, Renderer
from benchnav.envs.seeding import joint_seed, plain_seed
from benchnav.errors import UsageError

PICTURE = 240  # [pixels] of one slot: many are shown together
Stepped = tuple[Float32Array, FloatArray, BoolArray, BoolArray, dict[str, Any]]


class LeaderVectorEnv(VectorEnv[Float32Array, Float32Array, Any]):
    """Slots of a batch, row by row. A slot is terminated or truncated once in each attempt.

    It is idle from then until its row starts again: it observes zeros and gets no reward. The
    row starts again in the step in which its last attempt ends, or, with
    `AutoresetMode.NEXT_STEP`, in the step after it. ``info["idle"]`` (N,) marks slots
    that are idle now, ``info["acted"]`` (N,) slots with a decision in the last step: a learner
    ignores the others, and `AttemptStatistics` excludes them from the lengths of episodes.
    """

    metadata: ClassVar[dict[str, Any]] = {  # type: ignore[misc]
        "render_modes": [RGB_ARRAY],
        "render_fps": FPS,
        "autoreset_mode": AutoresetMode.SAME_STEP,
    }

    def __init__(
        self,
        num_envs: int | None = 4,
        scenario: str = "leaders/static",
        encoder: str = "ego",
        *,
        split: str = "train",
        worlds: int = 100,
        reward: Reward = None,
        others: None = None,
        render_mode: str | None = None,
        num_worlds: int = 1,
        autoreset_mode: AutoresetMode | str = AutoresetMode.SAME_STEP,
        perception: str = "exact",
    ) -> None:
        """Draw the worlds. The parameters are those of `LeaderEnv`, except for five.

        ``num_envs`` is N = B L, a multiple of the learning agents of a world, or None: then
        ``num_worlds`` gives B. ``others`` must be None, because all agents without a driver of the
        scenario learn. ``render_mode`` is "rgb_array" or None; Gymnasium's wrapper
        `HumanRendering` shows the pictures in a window. ``autoreset_mode`` is SAME_STEP or
        NEXT_STEP, as a member of `AutoresetMode` or its value; films need NEXT_STEP to show the
        last picture of an attempt.

        Raises BenchnavError for a mistake in any of these.
        """
        check_render_mode(render_mode, (RGB_ARRAY,))
        if others is not None:
            raise UsageError(
                "Every agent learns here: `others` must be None. Got"
                f" {others!r} instead; vectorization_mode='sync' has others."
            )
        self._mode = _mode(autoreset_mode)
        self.metadata = {**self.metadata, "autoreset_mode": self._mode}  # type: ignore[misc]
        self.batch = make_batch(
            scenario, encoder, split, worlds, reward, num_envs, rows=num_worlds,
            autoreset=Autoreset(self._mode.value), perception=perception,
        )  # fmt: skip
        self._slots = LearnerSlots(self.batch)
        self.render_mode, self._renderer = render_mode, Renderer(self.batch.simulation, PICTURE)
        self.num_envs, self._begun = self._slots.size, False
        self.single_observation_space = observation_space(self.batch.encoder)
        self.single_action_space = action_space()
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Float32Array, dict[str, Any]]:
        """Start every row. A seed determines the order of all further worlds.

        A list of N seeds counts as one seed, because sub-environments share worlds.
        """
        given = seed is not None
        if isinstance(seed, Sequence | np.ndarray):
            joint = joint_seed(seed, self.num_envs)
            given = joint is not None
            if joint is not None:
                sequence = np.random.SeedSequence(joint)
                self.np_random = np.random.Generator(np.random.PCG64(sequence))
        else:
            super().reset(seed=plain_seed(seed))
        if given or not self._begun:
            self.batch.reseed(self.np_random.spawn(1)[0])
        self._begun = True
        seen = self._flat(self._slots.reset())
        return seen, self._masked({"idle": self._idle()}, np.ones(self.num_envs, np.bool_))

    def step(self, actions: Float32Array) -> Stepped:
        """Execute one decision. ``actions`` (N, 2) in [-1, 1]; those of idle slots are ignored."""
        step = self._slots.step(actions)
        terminated = (step.arrived | step.touched).reshape(-1)
        reward: FloatArray = step.reward.reshape(-1)
        seen = self._flat(step.observation)
        if self._mode is AutoresetMode.NEXT_STEP:
            over = step.over.reshape(-1, 1)
            seen = np.where(over, self._flat(last_seen(step)), seen)
        return seen, reward, terminated, step.timed_out.reshape(-1), self._info(step)

    def render(self) -> tuple[ByteArray, ...] | None:
        """Return a picture (H, W, 3) for each slot, with a ring around its agent if it acts.

        Slots of a row share a world. A row that started again shows its next world. Returns None
        without a render mode. Raises UsageError before the first reset.
        """
        if self.render_mode is None:
            return None
        if not self._begun:
            raise UsageError("There is no world to draw: call reset() before render().")
        pictures: list[ByteArray] = []
        for row, agents in enumerate(np.where(self._slots.active, self._slots.agent, -1)):
            marked = [int(agent) if agent >= 0 else None for agent in agents]
            pictures += self._renderer.frames(row, marked)
        return tuple(pictures)

    def _info(self, step: Transition) -> dict[str, Any]:
        acted, over = step.acted.reshape(-1), step.over.reshape(-1)
        named = {name: term.reshape(-1) for name, term in terms(step).items()}
        always = {"idle": self._idle(), "acted": acted}
        info = self._masked(always, np.ones(self.num_envs, np.bool_))
        info |= self._masked({"terms": self._masked(named, acted)}, acted)
        ended = {"is_success": step.arrived.reshape(-1)}
        if over.any() and self._mode is AutoresetMode.NEXT_STEP:
            info |= self._masked(ended, over)
        elif over.any():
            final = np.full(self.num_envs, None, dtype=object)
            last = self._flat(last_seen(step))
            for slot in np.flatnonzero(over):
                final[slot] = last[slot]
            result = self._masked(ended, over)
            info |= self._masked({"final_obs": final, "final_info": result}, over)
        return info

    def _idle(self) -> BoolArray:
        return ~self._slots.active.reshape(-1)

    def _flat(self, array: Float32Array) -> Float32Array:
        return array.reshape(self.num_envs, -1)

    @staticmethod
    def _masked(values: dict[str, Any], mask: BoolArray) -> dict[str, Any]:
        """Return ``values`` in Gymnasium's form, with the mask (N,) of its slots for each key."""
        return values | {f"_{key}": mask for key in values}


def _mode(given: AutoresetMode | str) -> AutoresetMode:
    """Return the mode. Raises UsageError for one in which rows do not start again."""
    known = (AutoresetMode.SAME_STEP, AutoresetMode.NEXT_STEP)
    for mode in known:
        if given in (mode, mode.value):
            return mode
    allowed = " or ".join(repr(mode.value) for mode in known)
    raise UsageError(f"The autoreset_mode must be {allowed}. Got {given!r} instead.")
