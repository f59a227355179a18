"""sb3-contrib's recurrent policy with each sequence as one call of the LSTM."""

from typing import Any

import torch
from sb3_contrib.common.recurrent.policies import RecurrentActorCriticPolicy


class FusedPolicy(RecurrentActorCriticPolicy):
    """The stock class loops over a batch's steps as soon as any episode starts in it.

    Sequences are cut where episodes start, so masking the state that a sequence begins
    with does the same in one call. With ``bfloat16``, matrix products of
    the learner are in bfloat16.
    """

    bfloat16: bool = False

    def evaluate_actions(self, *args: Any, **kwargs: Any) -> Any:
        with torch.autocast(self.device.type, torch.bfloat16, enabled=self.bfloat16):
            results = super().evaluate_actions(*args, **kwargs)
        return tuple(part.float() for part in results)

    @staticmethod
    def _process_sequence(
        features: torch.Tensor, lstm_states: Any, episode_starts: torch.Tensor, lstm: Any
    ) -> Any:
        sequences = lstm_states[0].shape[1]
        starts = episode_starts.reshape(sequences, -1)
        if bool((starts[:, 1:] != 0.0).any()):
            return RecurrentActorCriticPolicy._process_sequence(
                features, lstm_states, episode_starts, lstm
            )
        keep = (1.0 - starts[:, 0]).view(1, sequences, 1)
        over_time = features.reshape(sequences, -1, lstm.input_size).swapaxes(0, 1)
        output, states = lstm(over_time, (keep * lstm_states[0], keep * lstm_states[1]))
        return output.transpose(0, 1).flatten(0, 1), states
