"""sb3-contrib's recurrent policy with matrix products in the chosen precision."""

from typing import Any

import torch
from sb3_contrib.common.recurrent.policies import RecurrentActorCriticPolicy


class MixedPrecisionPolicy(RecurrentActorCriticPolicy):
    """With ``bfloat16``, matrix products of the learner are in bfloat16; weights stay float32."""

    bfloat16: bool = False

    def evaluate_actions(self, *args: Any, **kwargs: Any) -> Any:
        with torch.autocast(self.device.type, torch.bfloat16, enabled=self.bfloat16):
            results = super().evaluate_actions(*args, **kwargs)
        return tuple(part.float() for part in results)
