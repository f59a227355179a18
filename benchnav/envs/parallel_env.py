"""PettingZoo's ParallelEnv: the learning agents of one world; each leaves after its attempt."""

from typing import Any, ClassVar

import numpy as np
from gymnasium.utils.seeding import np_random
from pettingzoo import ParallelEnv  # type: ignore[import-untyped]

from benchnav.arrays import ByteArray
from benchnav.envs.agent_batch import Autoreset
from benchnav.envs.encoders.encoder import Float32Array
from benchnav.envs.factory import Reward, check_render_mode, drawn_index, make_batch
from benchnav.envs.gym.spaces import Space, action_space, last_seen, observation_space, terms
from benchnav.envs.learner_slots import LearnerSlots
from benchnav.envs.rendering import FPS, RENDER_MODES, Display
from benchnav.envs.seeding import plain_seed
from benchnav.errors import UsageError

Infos = dict[str, dict[str, Any]]
Stepped = tuple[
    dict[str, Float32Array], dict[str, float], dict[str, bool], dict[str, bool], Infos
]  # fmt: skip


class LeadersEnv(ParallelEnv[str, Float32Array, Float32Array]):  # type: ignore[misc]
    """Agents ``leader_0``, ``leader_1``, … of a world that is newly drawn in each episode.

    These are the agents that learn; agents that the scenario's own drivers move have no name. An
    agent is terminated by arrival or contact, and truncated by time. Then it leaves.
    """

    metadata: ClassVar[dict[str, Any]] = {
        "render_modes": list(RENDER_MODES), "render_fps": FPS, "name": "benchnav_leaders_v0",
    }  # fmt: skip

    def __init__(
        self,
        scenario: str = "leaders/static",
        encoder: str = "ego",
        *,
        split: str = "train",
        worlds: int = 100,
        reward: Reward = None,
        render_mode: str | None = None,
        perception: str = "exact",
    ) -> None:
        """Draw the worlds. The parameters are those of `LeaderEnv`.

        Raises BenchnavError for a mistake in any of these.
        """
        check_render_mode(render_mode, RENDER_MODES)
        self.render_mode = render_mode
        self.batch = make_batch(
            scenario, encoder, split, worlds, reward, autoreset=Autoreset.DISABLED,
            perception=perception,
        )  # fmt: skip
        self._slots = LearnerSlots(self.batch)
        self.possible_agents = [f"leader_{a}" for a in range(self._slots.size)]
        self.agents: list[str] = []
        self.observation_spaces = {
            agent: observation_space(self.batch.encoder) for agent in self.possible_agents
        }
        self.action_spaces = {agent: action_space() for agent in self.possible_agents}
        self._rng: np.random.Generator | None = None
        self._display = Display(render_mode, self.batch.simulation, scenario)

    def observation_space(self, agent: str) -> Space:
        """Return the space (D,) of one agent, always the same object."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> Space:
        """Return the space (2,) of one agent, always the same object."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Float32Array], Infos]:
        """Start the world ``options["world"]`` of the pool; by default, draw one."""
        if seed is not None or self._rng is None:
            self._rng, _ = np_random(plain_seed(seed))
        world = drawn_index(self._rng, "world", options, self.batch.learnable)
        self.batch.reseed(self._rng.spawn(1)[0])
        seen = self._slots.reset(np.array([world]))[0]
        learners = int(self._slots.active[0].sum())
        self.agents = self.possible_agents[:learners]
        self._display.refresh()
        return (
            {agent: seen[a].copy() for a, agent in enumerate(self.agents)},
            {agent: {"world": world} for agent in self.agents},
        )

    def step(self, actions: dict[str, Float32Array]) -> Stepped:
        """Execute one decision. ``actions``: (2,) in [-1, 1] for each of ``agents``.

        Infos contain the reward's ``terms`` before scaling, and ``is_success``: the agent arrived
        without a contact. Returns empty dicts if no agent is left. Raises UsageError if an agent
        gets no action.
        """
        if not self.agents:
            return {}, {}, {}, {}, {}
        missing = [agent for agent in self.agents if agent not in actions]
        if missing:
            raise UsageError(f"Every agent in `agents` must get an action. {missing[0]} got none.")
        slots = {agent: self.possible_agents.index(agent) for agent in self.agents}
        action = np.zeros((1, self._slots.size, 2))
        for agent, a in slots.items():
            action[0, a] = actions[agent]
        step = self._slots.step(action)
        self._display.refresh()
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

    def render(self) -> ByteArray | None:
        """Return the world now as a picture (H, W, 3).

        Returns None in the mode "human", which shows it, and without a mode. Raises UsageError
        before the first reset.
        """
        if self.render_mode is None:
            return None
        if self._rng is None:
            raise UsageError("There is no world to draw: call reset() before render().")
        return self._display.frame()

    def close(self) -> None:
        """Close the window of the mode "human"."""
        self._display.close()
