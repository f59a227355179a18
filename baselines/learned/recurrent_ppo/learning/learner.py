"""The learners: sb3-contrib's RecurrentPPO, and SB3's PPO for a recipe without memory."""

from typing import Any

import numpy as np
import torch
from sb3_contrib import RecurrentPPO

from benchnav.envs import AgentVecEnv, AttemptPPO

from ..actor import Float32Array
from ..policy import MixedPrecisionPolicy
from .buffer import SequenceBuffer
from .collector import Collector
from .learner_group import LearnerGroup
from .recipe import Precision, Recipe, Stage


class SequencePPO(RecurrentPPO):
    """RecurrentPPO whose rollouts are cut into short sequences without idle transitions."""

    policy: MixedPrecisionPolicy
    rollout_buffer: SequenceBuffer
    _collector: Collector | None = None

    def _setup_model(self) -> None:
        super()._setup_model()
        lstm = self.policy.lstm_actor
        self.rollout_buffer = SequenceBuffer(
            self.n_steps, self.observation_space, self.action_space, self.device,
            gamma=self.gamma, gae_lambda=self.gae_lambda, n_envs=self.n_envs,
            state=(2, 2, lstm.num_layers, lstm.hidden_size),
        )  # fmt: skip

    def collect_rollouts(
        self, env: Any, callback: Any, rollout_buffer: Any, n_rollout_steps: int
    ) -> bool:
        if self._collector is None:
            self._collector = Collector(env, self.policy, self._last_obs)
        self.policy.set_training_mode(False)
        self._collector.fill(rollout_buffer, self.gamma)
        self.num_timesteps += self.n_envs * n_rollout_steps
        return True

    def join(self, group: LearnerGroup) -> None:
        """Learn as one of a group: the same minibatches in number, and the mean of gradients."""
        self.rollout_buffer.group = group
        group.average_gradients(self.policy)

    def forget(self) -> None:
        """Reset all memories; the environment must have been reset."""
        self._collector = None


Learner = SequencePPO | AttemptPPO


def make_learner(recipe: Recipe, env: AgentVecEnv, seed: int, device: str) -> Learner:
    """Return a new learner; its weights are initialised from ``seed``."""
    network = recipe.network
    shared: dict[str, Any] = {
        "n_steps": recipe.rollout, "gamma": recipe.gamma, "gae_lambda": recipe.gae_lambda,
        "clip_range": recipe.clip, "device": device, "seed": seed,
    }  # fmt: skip
    policy: dict[str, Any] = {
        "net_arch": list(network.dense), "log_std_init": network.log_std,
        "optimizer_kwargs": {"fused": True, "eps": 1e-5},  # eps: the default of SB3,
    }  # fmt: skip
    if network.lstm_layers:
        policy |= {"lstm_hidden_size": network.lstm_size, "n_lstm_layers": network.lstm_layers}
        learner: Learner = SequencePPO(MixedPrecisionPolicy, env, policy_kwargs=policy, **shared)
        buffer_of(learner).length = recipe.sequence
    else:
        learner = AttemptPPO(
            "MlpPolicy", env, policy_kwargs=policy,
            batch_size=recipe.rollout * env.num_envs, **shared,
        )  # fmt: skip
    return learner


def native_precision(device: torch.device) -> Precision:
    """Return "bfloat16" where the processor multiplies such numbers itself, else "float32"."""
    native = device.type == "cpu" and torch.cpu._is_avx512_bf16_supported()
    return "bfloat16" if native else "float32"


def set_precision(learner: Learner, precision: Precision) -> None:
    """Set the precision of the matrix products of recurrent networks."""
    if isinstance(learner, SequencePPO):
        learner.policy.half_products = precision == "bfloat16"


def copy_state(source: Learner, target: Learner) -> None:
    """Copy policy, optimiser and precision of ``source`` to ``target``."""
    target.policy.load_state_dict(source.policy.state_dict())
    target.policy.optimizer.load_state_dict(source.policy.optimizer.state_dict())
    if isinstance(source, SequencePPO) and isinstance(target, SequencePPO):
        target.policy.half_products = source.policy.half_products


def buffer_of(learner: Learner) -> Any:
    """Return its rollouts: a `SequenceBuffer` or a `LiveBuffer`."""
    return learner.rollout_buffer


def enter(learner: Learner, stage: Stage, progress: float) -> None:
    """Apply the settings of a stage, at the share ``progress`` of its decisions."""
    rate = _between(stage.learning_rate, progress)
    learner.lr_schedule = lambda _: rate
    learner.batch_size, learner.n_epochs = stage.batch, stage.epochs
    learner.ent_coef = stage.entropy
    log_std = learner.policy.log_std
    log_std.requires_grad_(stage.log_std is None)
    if stage.log_std is not None:
        log_std.grad = None
        log_std.data.fill_(_between(stage.log_std, progress))


def set_discount(learner: Learner, gamma: float) -> None:
    """Set the discount of rewards."""
    learner.gamma = buffer_of(learner).gamma = gamma


def _between(ends: tuple[float, float], share: float) -> float:
    first, last = ends
    return first + (last - first) * min(share, 1.0)


def reseed(learner: Learner, rng: np.random.Generator) -> None:
    """Make every further draw depend on ``rng`` only."""
    torch.manual_seed(int(rng.integers(2**63)))
    buffer_of(learner).rng = rng


def actor_tensors(learner: Learner) -> dict[str, Float32Array]:
    """Return the actor's tensors in the format of `Actor`."""
    state = {k: v.detach().cpu().numpy() for k, v in learner.policy.state_dict().items()}
    tensors: dict[str, Float32Array] = {}
    k = 0
    while f"lstm_actor.weight_ih_l{k}" in state:
        both = [state[f"lstm_actor.weight_{part}_l{k}"] for part in ("ih", "hh")]
        tensors[f"lstm{k}.weight"] = np.ascontiguousarray(np.concatenate(both, axis=1).T)
        tensors[f"lstm{k}.bias"] = (
            state[f"lstm_actor.bias_ih_l{k}"] + state[f"lstm_actor.bias_hh_l{k}"]
        )
        k += 1
    k = 0
    while f"mlp_extractor.policy_net.{2 * k}.weight" in state:
        name = f"mlp_extractor.policy_net.{2 * k}"
        tensors[f"dense{k}.weight"] = np.ascontiguousarray(state[f"{name}.weight"].T)
        tensors[f"dense{k}.bias"] = state[f"{name}.bias"]
        k += 1
    tensors["output.weight"] = np.ascontiguousarray(state["action_net.weight"].T)
    tensors["output.bias"] = state["action_net.bias"]
    return {name: np.ascontiguousarray(t, np.float32) for name, t in tensors.items()}
