"""PettingZoo's ParallelEnv: all agents of one world learn; who is done leaves."""

from typing import Any, ClassVar

import numpy as np
from gymnasium.utils.seeding import np_random
from pettingzoo import ParallelEnv  # type: ignore[import-untyped]

from benchnav.envs.encoders.encoder import Float32Array
from benchnav.envs.making import Reward, make_batch, refuse_rendering
from benchnav.envs.spaces import Space, action_space, last_seen, observation_space, terms
from benchnav.errors import UsageError

Told = dict[str, dict[str, Any]]
Stepped = tuple[
    dict[str, Float32Array], dict[str, float], dict[str, bool], dict[str, bool], Told
]  # fmt: skip


class LeadersEnv(ParallelEnv[str, Float32Array, Float32Array]):  # type: ignore[misc]
    """Agents ``leader_0``, ``leader_1``, … of a world that is drawn anew in each episode.

    An agent is terminated on arriving or touching anything and truncated by time; it has
    no body any more then, and is not told of again.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": [], "name": "benchnav_leaders_v0"}

    def __init__(
        self,
        scenario: str = "leaders/static",
        encoder: str = "ego",
        *,
        split: str = "train",
        worlds: int = 100,
        reward: Reward = None,
        render_mode: str | None = None,
    ) -> None:
        """Draws the worlds. The parameters are those of `LeaderEnv`.

        Raises BenchnavError for a mistake in any of these.
        """
        refuse_rendering(render_mode)
        self.render_mode = render_mode
        self.batch = make_batch(scenario, encoder, split, worlds, reward)
        self.possible_agents = [f"leader_{a}" for a in range(self.batch.width)]
        self.agents: list[str] = []
        self.observation_spaces = {
            agent: observation_space(self.batch.encoder) for agent in self.possible_agents
        }
        self.action_spaces = {agent: action_space() for agent in self.possible_agents}
        self._rng: np.random.Generator | None = None

    def observation_space(self, agent: str) -> Space:
        """(D,) of one agent, always the same object."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> Space:
        """(2,) of one agent, always the same object."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Float32Array], Told]:
        """Start a world: the one of the pool that ``options["world"]`` says, or any."""
        if seed is not None or self._rng is None:
            self._rng, _ = np_random(seed)
        pool = self.batch.simulation.pool
        world = int((options or {}).get("world", self._rng.integers(len(pool))))
        if not 0 <= world < len(pool):
            raise UsageError(
                f"The option 'world' must be from 0 to {len(pool) - 1}. Got {world} instead."
            )
        seen = self.batch.reset(np.array([world]))[0]
        self.agents = self.possible_agents[: len(pool[world].agents)]
        return (
            {agent: seen[a].copy() for a, agent in enumerate(self.agents)},
            {agent: {"world": world} for agent in self.agents},
        )

    def step(self, actions: dict[str, Float32Array]) -> Stepped:
        """Decide. ``actions``: (2,) in [-1, 1] of each of ``agents``.

        Infos hold the reward's ``terms`` before scaling and ``is_success``: it arrived, and
        touched nothing before. Raises UsageError where an agent gets no action.
        """
        lacking = [agent for agent in self.agents if agent not in actions]
        if lacking:
            raise UsageError(f"Every agent in `agents` must get an action. {lacking[0]} got none.")
        slots = {agent: self.possible_agents.index(agent) for agent in self.agents}
        action = np.zeros((1, self.batch.width, 2))
        for agent, a in slots.items():
            action[0, a] = actions[agent]
        step = self.batch.step(action)
        seen, named, ended = last_seen(step)[0], terms(step), step.arrived | step.touched
        stepped: Stepped = (
            {agent: seen[a].copy() for agent, a in slots.items()},
            {agent: float(step.reward[0, a]) for agent, a in slots.items()},
            {agent: bool(ended[0, a]) for agent, a in slots.items()},
            {agent: bool(step.timed_out[0, a]) for agent, a in slots.items()},
            {
                agent: {
                    "is_success": bool(step.arrived[0, a]),
                    "terms": {name: float(term[0, a]) for name, term in named.items()},
                }
                for agent, a in slots.items()
            },
        )
        self.agents = [agent for agent, a in slots.items() if not step.over[0, a]]
        return stepped

    def render(self) -> None:
        """Draws nothing."""
