"""Stable-Baselines3's PPO, which learns from decisions only."""

from typing import Any

from stable_baselines3 import PPO

from benchnav.envs.sb3.agent_vec_env import AgentVecEnv
from benchnav.envs.sb3.live_buffer import LiveBuffer
from benchnav.errors import UsageError


class AttemptPPO(PPO):
    """PPO that excludes the steps at which slots of an `AgentVecEnv` are idle."""

    def _setup_model(self) -> None:
        self.rollout_buffer_class = LiveBuffer
        super()._setup_model()

    def collect_rollouts(
        self, env: Any, callback: Any, rollout_buffer: Any, n_rollout_steps: int
    ) -> bool:
        rollout_buffer.env = env.unwrapped
        if not isinstance(rollout_buffer.env, AgentVecEnv):
            raise UsageError(
                f"AttemptPPO learns in an AgentVecEnv. Got {type(rollout_buffer.env).__name__}"
                " instead; use PPO there."
            )
        return super().collect_rollouts(env, callback, rollout_buffer, n_rollout_steps)
