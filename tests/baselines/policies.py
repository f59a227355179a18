"""Policies of other libraries, untrained, and what these libraries answer."""

import warnings

import numpy as np
import sb3_contrib
import stable_baselines3
import torch

import benchnav

SMALL = {"net_arch": [8, 8]}
OFF_POLICY = {"SAC", "TD3", "DDPG", "TQC"}


def learner(name, encoder="ego", **options):
    """An untrained learner of either library, with few neurons."""
    env = benchnav.make_env("leaders/static", kind="sb3", encoder=encoder, worlds=2, num_worlds=1)
    kind = getattr(stable_baselines3, name, None) or getattr(sb3_contrib, name)
    policy = {**SMALL, **options.pop("policy_kwargs", {})}
    if name == "RecurrentPPO":
        policy = {"lstm_hidden_size": 8, "n_lstm_layers": 2, **policy}
    options |= {"buffer_size": 10} if name in OFF_POLICY else {}
    options |= {} if name in OFF_POLICY or name == "A2C" else {"n_steps": 8}
    options |= {"batch_size": 8} if name in ("PPO", "TRPO", "RecurrentPPO") else {}
    family = "MlpLstmPolicy" if name == "RecurrentPPO" else "MlpPolicy"
    made = kind(family, env, policy_kwargs=policy, seed=1, device="cpu", **options)
    with torch.no_grad():  # the last layer of a new policy is nearly zero
        if hasattr(made.policy, "action_net"):
            made.policy.action_net.weight.mul_(60.0)
    return made


def observations(steps=4, agents=5, size=62):
    return np.random.default_rng(0).uniform(-1, 1, (steps, agents, size)).astype(np.float32)


def answers(made, seen):
    """The library's own deterministic actions, (steps, agents, 2)."""
    state, start, out = None, np.ones(seen.shape[1], bool), []
    for x in seen:
        action, state = made.predict(x, state, start, deterministic=True)
        start = np.zeros_like(start)
        out.append(action)
    return np.array(out)


def driven(policy, seen):
    """The actions of a loaded policy, (steps, agents, 2)."""
    state = np.zeros((seen.shape[1], policy.network.state_size), np.float32)
    return np.array([policy.actions(x, state) for x in seen])


class FeedForward(torch.nn.Module):
    """The deterministic action of a policy without memory, for an export."""

    def __init__(self, policy):
        super().__init__()
        self.policy = policy

    def forward(self, x):
        return self.policy._predict(x, deterministic=True)


class Recurrent(torch.nn.Module):
    """The deterministic action and the new states of a recurrent policy, for an export."""

    def __init__(self, policy):
        super().__init__()
        self.policy = policy

    def forward(self, x, h, c):
        p = self.policy
        latent, (h, c) = p.lstm_actor(x.unsqueeze(0), (h, c))
        return p.action_net(p.mlp_extractor.policy_net(latent.squeeze(0))), h, c


def export(made, path):
    """Write the ONNX file of a policy."""
    x, state = torch.zeros(1, 62), torch.zeros(2, 1, 8)
    recurrent = hasattr(made.policy, "lstm_actor")
    module = (Recurrent if recurrent else FeedForward)(made.policy)
    with warnings.catch_warnings():  # the exporter that needs no further package is an older one
        warnings.simplefilter("ignore")
        torch.onnx.export(module, (x, state, state) if recurrent else (x,), str(path), dynamo=False)
