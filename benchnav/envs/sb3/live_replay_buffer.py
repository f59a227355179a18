"""The replay buffer of Stable-Baselines3 without the steps at which slots are idle."""

from typing import Any

from stable_baselines3.common.buffers import ReplayBuffer


class LiveReplayBuffer(ReplayBuffer):
    """Keeps decisions only, for SAC, TD3 and others: ``replay_buffer_class=LiveReplayBuffer``.

    Decisions of all slots lie one after the other, because slots are not idle at the same time.
    """

    def __init__(self, *args: Any, n_envs: int = 1, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs | {"n_envs": 1})

    def add(
        self, obs: Any, next_obs: Any, action: Any, reward: Any, done: Any,
        infos: list[dict[str, Any]],
    ) -> None:  # fmt: skip
        """Add one step of an `AgentVecEnv`, whose infos distinguish decisions."""
        for i, info in enumerate(infos):
            if not info["idle"]:
                one = slice(i, i + 1)
                super().add(obs[one], next_obs[one], action[one], reward[one], done[one], [info])
