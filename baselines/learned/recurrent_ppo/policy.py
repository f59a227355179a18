"""sb3-contrib's recurrent policy with matrix products in the chosen precision."""

from typing import Any

import torch
from sb3_contrib.common.recurrent.policies import RecurrentActorCriticPolicy


class MixedPrecisionPolicy(RecurrentActorCriticPolicy):
    """With ``half_products``, the learner multiplies matrices in bfloat16; weights are float32."""

    half_products: bool = False

    def evaluate_actions(self, *args: Any, **kwargs: Any) -> Any:
        with torch.autocast(self.device.type, torch.bfloat16, enabled=self.half_products):
            results = super().evaluate_actions(*args, **kwargs)
        return tuple(part.float() for part in results)
