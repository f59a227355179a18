"""Stable-Baselines3's VecMonitor for environments whose slots may idle between attempts."""

from typing import Any, cast

import numpy as np
from stable_baselines3.common.vec_env import VecEnv, VecMonitor

from benchnav.envs.sb3.agent_vec_env import AgentVecEnv
from benchnav.errors import UsageError


class AttemptMonitor(VecMonitor):
    """VecMonitor without idle steps, for an `AgentVecEnv`.

    Both monitors count only attempts. This one counts only decisions in their lengths. It also
    marks a slot as done when an attempt follows an idle period, without an ``episode`` in its
    info. Recurrent policies then begin each attempt with an empty memory, in training and in
    `evaluate_policy`, and no value passes from an attempt to the idle period before it.
    """

    def __init__(self, venv: VecEnv, *args: Any, **kwargs: Any) -> None:
        if not isinstance(venv.unwrapped, AgentVecEnv):
            raise UsageError(
                f"AttemptMonitor wraps an AgentVecEnv. Got {type(venv.unwrapped).__name__}"
                " instead; use VecMonitor there."
            )
        super().__init__(venv, *args, **kwargs)

    def step_wait(self) -> Any:
        observation, reward, done, infos = super().step_wait()
        env = cast(AgentVecEnv, self.unwrapped)
        self.episode_lengths[~env.acted] = 0
        for slot in np.flatnonzero(env.woke):
            infos[slot]["terminal_observation"] = np.zeros(env.observation_space.shape, np.float32)
        return observation, reward, done | env.woke, infos
