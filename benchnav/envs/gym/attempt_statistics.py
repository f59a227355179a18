"""Gymnasium's RecordEpisodeStatistics for vector environments whose slots may idle."""

from time import perf_counter
from typing import Any

from gymnasium.wrappers.vector import RecordEpisodeStatistics


class AttemptStatistics(RecordEpisodeStatistics):
    """Statistics that leave idle steps out: use it in its place around a `LeaderVectorEnv`.

    Both count attempts, and only those. This one counts only decisions in their lengths.
    """

    def step(self, actions: Any) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        stepped = super().step(actions)
        waiting = ~stepped[4]["acted"]
        self.episode_lengths[waiting] = 0
        self.episode_start_times[waiting] = perf_counter()
        return stepped
