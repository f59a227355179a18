"""Environments for learning, from a scenario."""

from typing import TYPE_CHECKING, Any, Literal, overload

from benchnav.api.records.scenario import Scenario
from benchnav.errors import MissingExtraError, UsageError, did_you_mean

if TYPE_CHECKING:
    from benchnav.envs.factory import Reward
    from benchnav.envs.gym.leader_env import LeaderEnv
    from benchnav.envs.gym.leader_vector_env import LeaderVectorEnv
    from benchnav.envs.parallel_env import LeadersEnv
    from benchnav.envs.sb3.agent_vec_env import AgentVecEnv
    from benchnav.navigation.plugin.configure import Spec

Kind = Literal["vector", "sb3", "gymnasium", "pettingzoo"]
KINDS = ("vector", "sb3", "gymnasium", "pettingzoo")


@overload
def make_env(scenario: str | Scenario, *, num_worlds: int = ..., kind: Literal["vector"] = ...,
             encoder: str = ..., split: str = ..., worlds: int = ..., reward: "Reward" = ...,
             render_mode: str | None = ...,
             perception: str = ...) -> "LeaderVectorEnv": ...  # fmt: skip
@overload
def make_env(scenario: str | Scenario, *, num_worlds: int = ..., kind: Literal["sb3"],
             encoder: str = ..., split: str = ..., worlds: int = ..., reward: "Reward" = ...,
             render_mode: str | None = ...,
             perception: str = ...) -> "AgentVecEnv": ...  # fmt: skip
@overload
def make_env(scenario: str | Scenario, *, kind: Literal["gymnasium"], encoder: str = ...,
             split: str = ..., worlds: int = ..., reward: "Reward" = ..., others: "Spec",
             render_mode: str | None = ...,
             perception: str = ...) -> "LeaderEnv": ...  # fmt: skip
@overload
def make_env(scenario: str | Scenario, *, kind: Literal["pettingzoo"], encoder: str = ...,
             split: str = ..., worlds: int = ..., reward: "Reward" = ...,
             render_mode: str | None = ...,
             perception: str = ...) -> "LeadersEnv": ...  # fmt: skip
def make_env(
    scenario: str | Scenario,
    *,
    num_worlds: int | None = None,
    kind: Kind = "vector",
    encoder: str = "ego",
    split: str = "train",
    worlds: int = 100,
    reward: "Reward" = None,
    others: "Spec | None" = None,
    render_mode: str | None = None,
    perception: str = "exact",
) -> Any:
    """Return an environment in which agents of a scenario learn.

    Args:
        scenario: a name, a YAML file, or a `Scenario`.
        num_worlds: worlds that are stepped at once, for "vector" and "sb3"; None: 4. Each
            learning agent of each world is one sub-environment.
        kind: "vector" for Gymnasium's VectorEnv, "sb3" for Stable-Baselines3's VecEnv,
            "gymnasium" for one learning agent, "pettingzoo" for all agents of one world.
        encoder: what an agent observes: ego, paper, …
        split: train or validation. Worlds of the split test are for `benchnav.run`.
        worlds: how many different worlds of the split are drawn.
        reward: weights that are not the defaults, by name.
        others: for "gymnasium", which needs it: the navigator of the other agents.
        render_mode: "rgb_array": `render` returns pictures; "human", for "gymnasium" and
            "pettingzoo": a window shows every decision; None: nothing is drawn.
        perception: "exact", or "noisy": learning agents perceive with the noise of the scenario.

    Raises UsageError or ConfigError for a mistake in the call, and MissingExtraError where the
    extra ``learn`` is not installed.
    """
    name = scenario.name if isinstance(scenario, Scenario) else str(scenario)
    if kind not in KINDS:
        raise UsageError(
            f"The kind must be one of {', '.join(KINDS)}. Got {kind!r} instead."
            f"{did_you_mean(str(kind), KINDS)}"
        )
    if num_worlds is not None and kind in ("gymnasium", "pettingzoo"):
        raise UsageError(f"num_worlds is for the kinds vector and sb3. Got it with {kind!r}.")
    if others is None and kind == "gymnasium":
        raise UsageError(
            "The kind gymnasium needs others=NAME, the navigator of the other agents."
            " `benchnav list navigators` shows the names."
        )
    if others is not None and kind != "gymnasium":
        raise UsageError(f"others is for the kind gymnasium. Got it with {kind!r}.")
    rows = 4 if num_worlds is None else num_worlds
    try:
        options = {
            "split": split, "worlds": worlds, "reward": reward, "perception": perception,
        }  # fmt: skip
        return _made(kind, name, encoder, rows, others, render_mode, options)
    except ModuleNotFoundError as error:
        raise MissingExtraError(f"An environment of the kind {kind!r}", "learn") from error


def _made(
    kind: str, name: str, encoder: str, rows: int, others: "Spec | None", render_mode: str | None,
    options: dict[str, Any],
) -> Any:  # fmt: skip
    if kind == "vector":
        from benchnav.envs.gym.leader_vector_env import LeaderVectorEnv

        return LeaderVectorEnv(
            None, name, encoder, num_worlds=rows, render_mode=render_mode, **options
        )
    if kind == "gymnasium":
        from benchnav.envs.gym.leader_env import LeaderEnv

        return LeaderEnv(name, encoder, others=others, render_mode=render_mode, **options)
    if kind == "pettingzoo":
        from benchnav.envs.parallel_env import LeadersEnv

        return LeadersEnv(name, encoder, render_mode=render_mode, **options)
    from benchnav.envs.factory import make_batch
    from benchnav.envs.sb3.agent_vec_env import AgentVecEnv
    from benchnav.envs.sb3.attempt_monitor import AttemptMonitor

    batch = make_batch(name, encoder, rows=rows, **options)
    return AttemptMonitor(AgentVecEnv([batch], render_mode))
