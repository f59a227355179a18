"""A lower bound: a heading that diffuses."""

from collections.abc import Sequence

import numpy as np
from pydantic import Field

from benchnav.arrays import FloatArray, IntArray
from benchnav.geometry import cos_sin
from benchnav.navigation import Briefing, Navigator, Observation, PluginConfig, canonical_order


class RandomWalk(Navigator):
    """Drives at preferred speed in a direction that does a random walk.

    The direction turns by the Cayley map of a uniform variate, which needs no
    libm and so is equal on every machine.
    """

    class Config(PluginConfig):
        """Parameters."""

        turning: float = Field(
            1.0, ge=0, description="[rad/√s] standard deviation of the turn in one second"
        )

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._walks: dict[int, _Walk] = {}

    @property
    def uses_map(self) -> bool:
        return False

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        for row, briefing in zip(rows, briefings, strict=True):
            self._walks[int(row)] = _Walk(briefing, self.config.turning)

    def act(self, observation: Observation) -> FloatArray:
        command = np.zeros((*observation.active.shape, 2))
        for world, row in enumerate(observation.rows):
            velocity = self._walks[int(row)].step()
            command[world, : len(velocity)] = velocity
        return command


class _Walk:
    """The agents of one world, each with its direction (A, 2)."""

    def __init__(self, briefing: Briefing, turning: float) -> None:
        self.direction = np.array([cos_sin(float(angle)) for angle in briefing.heading])
        self.direction = self.direction.reshape(-1, 2)
        self.speed = briefing.preferred_speed[:, None]
        self.order = canonical_order(briefing)
        self.rng = briefing.rng
        self.half_turn = 0.5 * turning * np.sqrt(3.0 * briefing.dt)  # a uniform's bound is √3 σ

    def step(self) -> FloatArray:
        q = np.empty(len(self.order))
        q[self.order] = self.half_turn * (2.0 * self.rng.random(len(self.order)) - 1.0)
        c, s = (1.0 - q * q) / (1.0 + q * q), 2.0 * q / (1.0 + q * q)
        x, y = self.direction[:, 0], self.direction[:, 1]
        turned = np.stack([c * x - s * y, s * x + c * y], axis=-1)
        self.direction = turned / np.sqrt(np.sum(turned * turned, axis=-1, keepdims=True))
        velocity: FloatArray = self.speed * self.direction
        return velocity
