"""Gymnasium's RecordEpisodeStatistics for vector environments whose slots may idle."""

from time import perf_counter
from typing import Any

from gymnasium.wrappers.vector import RecordEpisodeStatistics


class AttemptStatistics(RecordEpisodeStatistics):
    """RecordEpisodeStatistics without idle steps, for a `LeaderVectorEnv`.

    Both wrappers count only attempts. This one counts only decisions in the length of an attempt.
    """

    def step(self, actions: Any) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        stepped = super().step(actions)
        waiting = ~stepped[4]["acted"]
        self.episode_lengths[waiting] = 0
        self.episode_start_times[waiting] = perf_counter()
        return stepped
