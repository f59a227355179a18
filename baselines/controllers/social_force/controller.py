"""Social forces towards the guide's target."""

import math
from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from pydantic import Field

from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation import (
    Briefing,
    Controller,
    Guide,
    Need,
    Observation,
    PluginConfig,
    RowTable,
    canonical_order,
)
from benchnav.threads import run_rows

from ...common.kernel_inputs import bodies_of, flat, sensed
from .kernel import Forces, social_force


class SocialForceConfig(PluginConfig):
    """Parameters of the social force model; values of the paper unless noted."""

    relaxation: float = Field(0.5, gt=0, description="[s] τ, of the speed")
    pedestrians: float = Field(2.1, ge=0, description="[m²/s²] V⁰ of the potential of a neighbour")
    pedestrian_range: float = Field(0.3, gt=0, description="[m] σ, at which it falls to 1/e")
    stride: float = Field(
        0.2,
        ge=0,
        description="[s] Δt, after which a neighbour's step ends (tuned; the paper says that a"
        " step is of the order of its width)",
    )
    borders: float = Field(10.0, ge=0, description="[m²/s²] U⁰ of the potential of a border")
    border_range: float = Field(0.2, gt=0, description="[m] R, at which it falls to 1/e")
    sight: float = Field(
        math.radians(200.0), gt=0, le=2 * math.pi, description="[rad] 2φ, angle of view"
    )
    behind: float = Field(
        0.5, ge=0, le=1, description="c, weight of forces from outside this angle"
    )
    top: float = Field(1.3, gt=0, description="largest speed as a multiple of the preferred one")
    border_body: float = Field(
        0.4,
        ge=0,
        description="[m] distances to borders start at the centre of bodies up to this radius, and"
        " this far inside larger ones (not from the paper)",
    )
    fluctuation: float = Field(
        0.02,
        ge=0,
        description="[m/s²] standard deviation of a constant acceleration of each agent, in x and"
        " in y; without it, agents in exact symmetry never move",
    )
    tick: float = Field(0.05, gt=0, description="[s] largest integration step (not from the paper)")


class SocialForce(Controller):
    """The social force model, with the guide's target as the desired place of each agent."""

    Config = SocialForceConfig
    needs: ClassVar[frozenset[Need]] = frozenset({Need.NEIGHBOURS, Need.EDGES})

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._table = RowTable()
        c = self.config
        self._forces = Forces(
            border_body=c.border_body, relaxation=c.relaxation, pedestrians=c.pedestrians,
            pedestrian_range=c.pedestrian_range, stride=c.stride, borders=c.borders,
            border_range=c.border_range, cosine=math.cos(0.5 * c.sight), behind=c.behind,
            top=c.top, tick=c.tick,
        )  # fmt: skip

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        for row, briefing in zip(rows, briefings, strict=True):
            push = np.empty((len(briefing), 2))
            push[canonical_order(briefing)] = briefing.rng.standard_normal(push.shape)
            push *= self.config.fluctuation
            self._table.put(int(row), body=bodies_of(briefing), push=push)

    def steer(self, observation: Observation, guide: Guide) -> FloatArray:
        agents = observation.active.shape[1]
        body, push = (self._table.take(name, observation.rows, agents) for name in ("body", "push"))
        return self._velocity(observation, guide.target, body, push)

    def _velocity(
        self, observation: Observation, target: FloatArray, body: FloatArray, push: FloatArray
    ) -> FloatArray:
        """Return velocities (B, A, 2) [m/s] towards ``target`` (B, A, 2) [m].

        ``body`` (B, A, 6) is as `bodies_of` returns it, ``push`` (B, A, 2) an acceleration [m/s²].
        """
        worlds, agents = observation.active.shape
        rows = worlds * agents
        position, velocity, radius, _, count, *edges = sensed(observation)
        arrays = (
            observation.active, observation.position, observation.velocity, target, body, push,
            position, velocity, radius, count, *edges,
        )  # fmt: skip
        answer = np.zeros((rows, 2))
        run_rows(social_force, rows, *flat(rows, arrays), self._forces, answer)
        return answer.reshape(worlds, agents, 2)
