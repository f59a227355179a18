"""Gymnasium's Env: one agent of one world learns, a navigator drives the others."""

from typing import Any, ClassVar

import gymnasium
import numpy as np

from benchnav.arrays import ByteArray
from benchnav.envs.agent_batch import Autoreset
from benchnav.envs.background_agents import BackgroundNavigator
from benchnav.envs.encoders.encoder import Float32Array
from benchnav.envs.factory import Reward, check_render_mode, drawn_index, make_batch
from benchnav.envs.gym.spaces import action_space, observation_space, terms
from benchnav.envs.rendering import FPS, RENDER_MODES, Display
from benchnav.envs.seeding import plain_seed
from benchnav.errors import UsageError
from benchnav.navigation.plugin.configure import Spec


class LeaderEnv(gymnasium.Env[Float32Array, Float32Array]):
    """One learning agent. An attempt is terminated by arrival or contact, and truncated by time.

    Each attempt has a newly drawn agent in a newly drawn world. Registered as
    ``benchnav/Leader-v0`` by `benchnav.envs.gym.registration`.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": list(RENDER_MODES), "render_fps": FPS}  # type: ignore[misc]

    def __init__(
        self,
        scenario: str = "leaders/static",
        encoder: str = "ego",
        *,
        split: str = "train",
        worlds: int = 100,
        reward: Reward = None,
        others: Spec | None = None,
        render_mode: str | None = None,
        perception: str = "exact",
    ) -> None:
        """Draw the worlds.

        Args:
            scenario: a name or a YAML file; agents with a driver of the scenario do not learn.
            encoder: encoder of observations, one of `encoders.catalogue.ENCODERS`.
            split: train or validation.
            worlds: number of worlds of the split.
            reward: weights that differ from the defaults of `RewardWeights`.
            others: the navigator of the other agents, by name or ``{"type": name, …}``; required.
            render_mode: "rgb_array": `render` returns a picture; "human": a window shows every
                decision in real time; None: nothing is drawn.
            perception: "exact", or "noisy": the learning agent perceives with the noise of the
                scenario, other agents without error.

        Raises BenchnavError for a mistake in any of these.
        """
        check_render_mode(render_mode, RENDER_MODES)
        self.render_mode = render_mode
        if others is None:
            raise UsageError(
                'others must name the navigator of the other agents: others="NAME".'
                " 'benchnav list navigators' shows all."
            )
        self.batch = make_batch(
            scenario, encoder, split, worlds, reward, autoreset=Autoreset.DISABLED,
            perception=perception,
        )  # fmt: skip
        self.observation_space = observation_space(self.batch.encoder)
        self.action_space = action_space()
        self.agent = 0
        self._others = BackgroundNavigator(
            others, self.batch.simulation, self.batch.width - 1, "others"
        )
        self._display = Display(render_mode, self.batch.simulation, scenario)
        self._begun = self._going = False

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Float32Array, dict[str, Any]]:
        """Start an attempt.

        Args:
            seed: determines all further worlds, agents, and draws of other navigators.
            options: ``world``, one of the pool, and ``agent``, one of the learning agents of
                that world; by default, they are drawn.

        Returns:
            The observation (D,), and an info with the keys ``world`` and ``agent``.
        """
        super().reset(seed=plain_seed(seed))
        others, drivers = self.np_random.spawn(2)
        self.batch.reseed(drivers)
        world = drawn_index(self.np_random, "world", options, self.batch.learnable)
        learners = np.flatnonzero(self.batch.simulation.pool[world].agents.evaluated)
        chosen = drawn_index(self.np_random, "agent", options, np.arange(len(learners)))
        self.agent = int(learners[chosen])
        self.batch.only = np.arange(self.batch.width)[None, :] == self.agent
        seen = self.batch.reset(np.array([world]))
        self._others.start(np.zeros(1, np.int64), [learners[learners != self.agent]], [others])
        self._begun = self._going = True
        self._display.refresh(self.agent)
        return seen[0, self.agent].copy(), {"world": world, "agent": chosen}

    def step(self, action: Float32Array) -> tuple[Float32Array, float, bool, bool, dict[str, Any]]:
        """Execute one decision. ``action`` (2,) in [-1, 1]: speed, turn rate.

        ``info`` contains the reward's ``terms`` before scaling, and ``is_success``: the agent
        arrived without a contact. Raises UsageError if the attempt is over.
        """
        if not self._going:
            raise UsageError("An attempt must begin before it goes on: call reset() first.")
        at = (0, self.agent)
        commands = np.zeros((1, self.batch.width, 2))
        commands[at] = action
        step = self.batch.step(commands, self._others.decide(self.batch.active))
        terminated, truncated = bool(step.arrived[at] or step.touched[at]), bool(step.timed_out[at])
        self._going = not (terminated or truncated)
        self._display.refresh(self.agent)
        info = {
            "is_success": bool(step.arrived[at]),
            "terms": {name: float(term[at]) for name, term in terms(step).items()},
        }
        seen = step.final[at].copy()
        if terminated:
            seen[:] = 0.0
        return seen, float(step.reward[at]), terminated, truncated, info

    def render(self) -> ByteArray | None:
        """Return the world now (H, W, 3), with a ring around the learning agent.

        Returns None in the mode "human", which shows it, and without a mode. Raises UsageError
        before the first reset.
        """
        if self.render_mode is None:
            return None
        if not self._begun:
            raise UsageError("There is no world to draw: call reset() before render().")
        return self._display.frame(self.agent)

    def close(self) -> None:
        """Close the window of the mode "human"."""
        self._display.close()
