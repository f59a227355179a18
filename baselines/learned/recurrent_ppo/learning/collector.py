"""Rollouts of recurrent policies: inference for active attempts only, in one call for each step."""

from typing import Any

import numpy as np
import torch
from torch import Tensor
from torch.distributions import Normal

from benchnav.envs import AgentVecEnv

from ..policy import MixedPrecisionPolicy
from .buffer import SequenceBuffer

ACTOR, CRITIC = 0, 1


class Networks:
    """Actor and critic for one decision of many agents; valid until the next update.

    Matrix products are in the precision of the policy; gates, cells and outputs are float32.
    """

    def __init__(self, policy: MixedPrecisionPolicy) -> None:
        self._policy = policy
        dtype = torch.bfloat16 if policy.bfloat16 else torch.float32
        self._lstms = [
            [
                (torch.cat([w_ih, w_hh], 1).to(dtype).t(), b_ih + b_hh)
                for w_ih, w_hh, b_ih, b_hh in lstm.all_weights
            ]
            for lstm in (policy.lstm_actor, policy.lstm_critic)
        ]

    def _advance(self, x: Tensor, state: Tensor, net: int) -> Tensor:
        """Return the LSTM's output (N, H), and advance ``state``, see `Collector`."""
        for layer, (matrix, bias) in enumerate(self._lstms[net]):
            h, c = state[:, net, 0, layer], state[:, net, 1, layer]
            both = torch.cat([x, h], 1).to(matrix.dtype)
            gates = torch.mm(both, matrix).float().add_(bias)
            keep, forget, fresh, out = gates.chunk(4, 1)
            c.mul_(forget.sigmoid_()).addcmul_(keep.sigmoid_(), fresh.tanh_())
            x = out.sigmoid_() * c.tanh()
            h.copy_(x)
        return x

    def act(self, x: Tensor, state: Tensor) -> tuple[Tensor, Tensor]:
        """Return sampled actions (N, 2) and their log-probabilities; advance ``state``."""
        policy = self._policy
        latent = policy.mlp_extractor.forward_actor(self._advance(x, state, ACTOR))
        normal = Normal(policy.action_net(latent), policy.log_std.exp(), validate_args=False)
        action = normal.sample()
        return action, normal.log_prob(action).sum(1)

    def value(self, x: Tensor, state: Tensor) -> Tensor:
        """Return values (N,); advance ``state``."""
        latent = self._policy.mlp_extractor.forward_critic(self._advance(x, state, CRITIC))
        return self._policy.value_net(latent)[:, 0]


class Collector:
    """The memories and last observations of all slots of an environment.

    A state is (2, 2, layers, H): actor and critic, hidden and cell.
    """

    def __init__(self, env: AgentVecEnv, policy: MixedPrecisionPolicy, observation: Any) -> None:
        lstm = policy.lstm_actor
        shape = (env.num_envs, 2, 2, lstm.num_layers, lstm.hidden_size)
        self._env, self._policy = env, policy
        self._memory = torch.zeros(shape, device=policy.device)
        self._observation = observation
        self._begins = np.ones(env.num_envs, np.bool_)

    @torch.no_grad()
    def fill(self, buffer: SequenceBuffer, gamma: float) -> None:
        """Fill a buffer with the next decisions, their advantages and returns."""
        env, networks = self._env, Networks(self._policy)
        buffer.reset()
        for step in range(buffer.buffer_size):
            slots = np.flatnonzero(env.active)
            memory = self._memory[slots]
            buffer.begin(step, slots, self._begins[slots], memory)
            x = self._tensor(self._observation[slots])
            action, log_prob = networks.act(x, memory)
            value = networks.value(x, memory)
            self._memory[slots] = memory
            actions = np.zeros((env.num_envs, 2), np.float32)
            actions[slots] = action.cpu().numpy()
            result = env.decide(np.clip(actions, -1.0, 1.0))
            reward = result.reward
            late = np.flatnonzero(result.timed_out)
            if len(late):  # the value of going on, as SB3 adds it
                memory = self._memory[late]
                rest = networks.value(self._tensor(result.final[late]), memory)
                reward[late] += gamma * rest.cpu().numpy()
            buffer.put(
                step, slots, self._observation[slots], actions[slots], reward[slots],
                value.cpu().numpy(), log_prob.cpu().numpy(),
            )  # fmt: skip
            self._observation, self._begins = result.observation, result.restarted
            self._memory[result.restarted] = 0.0
        last = torch.zeros(env.num_envs)
        slots = np.flatnonzero(env.active)
        last[slots] = networks.value(
            self._tensor(self._observation[slots]), self._memory[slots]
        ).cpu()
        buffer.compute_returns_and_advantage(last, result.over)

    def _tensor(self, array: Any) -> Tensor:
        return torch.as_tensor(array, device=self._policy.device)
