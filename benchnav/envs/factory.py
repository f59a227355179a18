"""Make the decision process of an environment from names and numbers."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from pydantic import ValidationError

from benchnav.arena.world import World
from benchnav.arrays import IntArray
from benchnav.config.model_errors import parameter_errors
from benchnav.envs.agent_batch import AgentBatch, Autoreset
from benchnav.envs.encoders.catalogue import encoder as encoder_called
from benchnav.envs.reward import RewardWeights
from benchnav.errors import ConfigError, UsageError, did_you_mean
from benchnav.generation.build import build, noise_of
from benchnav.scenario.catalogue import find
from benchnav.scenario.condition import NOISY, require_perception


class NoRenderingError(UsageError, TypeError):
    """Rendering is not possible. It is a TypeError, after which SB3's `make_vec_env` continues."""


Reward = RewardWeights | Mapping[str, Any] | None
LEARNING_SPLITS = ("train", "validation")


def make_worlds(scenario: str, split: str, count: int) -> list[World]:
    """Return the worlds 0 to ``count`` - 1 of a scenario's split.

    Raises:
        UsageError: no such split, or no worlds.
        UnknownPluginError: no such scenario.
    """
    if split not in LEARNING_SPLITS:
        raise UsageError(
            f"The split of an environment must be {' or '.join(LEARNING_SPLITS)}: worlds of the"
            f" split test are for `benchnav run`. Got {split!r} instead."
            f"{did_you_mean(split, LEARNING_SPLITS)}"
        )
    if count < 1:
        raise UsageError(f"An environment must have at least 1 world. Got {count} instead.")
    found = find(scenario)
    return [build(found, split, seed) for seed in range(count)]


def weights_of(reward: Reward) -> RewardWeights:
    """Return the weights of ``reward``; None: the defaults.

    Raises ConfigError if ``reward`` has an unknown or invalid weight.
    """
    if isinstance(reward, RewardWeights):
        return reward
    try:
        return RewardWeights(**(reward or {}))
    except ValidationError as error:
        lines = parameter_errors(error, RewardWeights, "reward", "weight")
        raise ConfigError("\n".join(text for _, text in lines)) from None


def make_batch(
    scenario: str, encoder: str, split: str, worlds: int, reward: Reward, slots: int | None = None,
    *, rows: int = 1, autoreset: Autoreset = Autoreset.SAME_STEP, perception: str = "exact",
) -> AgentBatch:  # fmt: skip
    """Return a batch of rows with ``slots`` learning agents in total, or of ``rows`` rows.

    In the perception track `noisy`, the learners' senses have the noise of the scenario; other
    agents perceive without error. The order of worlds is random until `AgentBatch.reseed` is
    called. Raises UsageError if ``slots`` is no multiple of a world's learning agents, or the
    perception is unknown, and the errors of `make_worlds`, `weights_of` and the catalogue of
    encoders.
    """
    require_perception(perception)
    noise = noise_of(find(scenario)) if perception == NOISY else None
    chosen, weights = encoder_called(encoder), weights_of(reward)
    pool, drivers = make_worlds(scenario, split, worlds), find(scenario).driver_specs
    L = max(int(world.agents.evaluated.sum()) for world in pool)
    if rows < 1:
        raise UsageError(f"An environment must step at least 1 world at once. Got {rows} instead.")
    if slots is not None:
        rows = max(slots // max(L, 1), 1)
        if slots != rows * L:
            least, most = f"at least {L}", f"a multiple of {L}"
            nearest = f"; the nearest below is {rows * L}" if slots > L else ""
            raise UsageError(
                "num_envs counts the agents that learn: it must be"
                f" {most if nearest else least}, the agents of a world of {scenario}."
                f" Got {slots} instead{nearest}."
            )
    return AgentBatch(
        pool, rows, chosen, weights, np.random.default_rng(), drivers=drivers,
        autoreset=autoreset, noise=noise,
    )  # fmt: skip


def drawn_index(
    rng: np.random.Generator, name: str, options: Mapping[str, Any] | None, allowed: IntArray
) -> int:
    """Return the option ``name``, or draw one of ``allowed`` (in rising order) if it is not given.

    One is drawn in both cases, so that an option does not change later draws. Raises UsageError
    if the option is not allowed.
    """
    drawn = int(allowed[int(rng.integers(len(allowed)))])
    chosen = int((options or {}).get(name, drawn))
    if chosen not in allowed:
        most = int(allowed[-1])
        span = f"from 0 to {most}" if len(allowed) == most + 1 else f"one of {allowed.tolist()}"
        raise UsageError(f"The option {name!r} must be {span}. Got {chosen} instead.")
    return chosen


def check_render_mode(render_mode: str | None, modes: Sequence[str] = ()) -> None:
    """Raise NoRenderingError for a mode that an environment does not have."""
    if render_mode is not None and render_mode not in modes:
        allowed = " or ".join(["None", *map(repr, modes)])
        raise NoRenderingError(f"The render_mode must be {allowed}. Got {render_mode!r} instead.")
