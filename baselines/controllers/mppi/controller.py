"""Model predictive path integral control towards the guide's target."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from pydantic import Field

from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation import (
    Briefing,
    CommandKind,
    Controller,
    Guide,
    Need,
    Observation,
    PluginConfig,
    RowTable,
    agent_streams,
)
from benchnav.threads import run_rows

from ...common.kernel_inputs import bodies_of, flat, sensed
from ...common.motion_limits import BACKWARDS, has_limits, limits_of, steering_after
from .kernel import control


class MppiConfig(PluginConfig):
    """Parameters of model predictive path integral control."""

    samples: int = Field(64, ge=3, description="number of plans at each decision")
    steps: int = Field(10, ge=2, description="twists of a plan")
    tick: float = Field(0.3, gt=0, description="[s] that each twist of a plan is held")
    knots: int = Field(6, ge=2, description="times in a plan at which noise is drawn")
    temperature: float = Field(
        0.15, gt=0, description="[m] λ: larger values give more weight to worse plans"
    )
    control_cost: float = Field(
        0.1, ge=0, description="γ / λ: cost of plans that deviate from the last one"
    )
    speed_noise: float = Field(
        0.5, gt=0, description="standard deviation of speeds, as a share of the preferred one"
    )
    turn_noise: float = Field(
        0.5, gt=0, description="standard deviation of turn rates, as a share of the largest"
    )
    margin: float = Field(
        0.05,
        ge=0,
        description="[m] gap to a neighbour that counts as a contact; half of it for edges",
    )
    contact: float = Field(
        20.0, ge=0, description="[m] cost of a contact; twice that in the first step"
    )
    probability: float = Field(
        1.0, ge=0, description="[m] cost of a collision probability (Eq. 24) of 1 all the time"
    )
    back: float = Field(
        1.0,
        ge=0,
        description="[m] cost of a contact in the first step if a dynamic obstacle reverses",
    )
    near: float = Field(
        3.0,
        ge=0,
        description="[m] cost of contact with a neighbour all the time; less for small gaps",
    )
    near_edges: float = Field(0.6, ge=0, description="[m] the same, for edges")
    clearance: float = Field(0.4, gt=0, description="[m] larger gaps have no cost")
    smooth: float = Field(
        0.1, ge=0, description="[m] cost of a change by the full preferred speed or turn rate"
    )


class Mppi(Controller):
    """Samples random variations of its last plan, and averages them with weights exp(−cost / λ).

    It commands twists; holonomic bodies follow them too. Every sample holds only twists that the
    body reaches one after another within its limits of acceleration, wheels and steering. It
    drives forward only: the mean of plans forwards and backwards stands still.
    """

    Config = MppiConfig
    needs: ClassVar[frozenset[Need]] = frozenset({Need.NEIGHBOURS, Need.EDGES})
    command: ClassVar[CommandKind] = "twist"

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._table = RowTable()
        self._streams: dict[int, list[np.random.Generator]] = {}

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        for row, briefing in zip(rows, briefings, strict=True):
            self._streams[int(row)] = agent_streams(briefing)
            plan = np.zeros((len(briefing), self.config.steps, 2))
            limits = limits_of(briefing)
            limits[:, BACKWARDS] = 0.0
            self._table.put(
                int(row), body=bodies_of(briefing), plan=plan, limits=limits,
                limited=has_limits(limits), steering=np.zeros(len(briefing)),
            )  # fmt: skip

    def steer(self, observation: Observation, guide: Guide) -> FloatArray:
        worlds, agents = observation.active.shape
        rows, c = worlds * agents, self.config
        body, plan, limited, limits, steering = (
            self._table.take(name, observation.rows, agents)
            for name in ("body", "plan", "limited", "limits", "steering")
        )
        position, velocity, radius, kind, count, start, end, _, _, edges = sensed(observation)
        arrays = (
            observation.active, observation.position, observation.heading, guide.target,
            guide.remaining, body, plan, limited, limits, steering, position, velocity,
            radius, kind, count, start, end, edges,
        )  # fmt: skip
        new = plan.reshape(rows, *plan.shape[2:]).copy()
        weights = np.array(
            [c.contact, c.probability, c.near, c.smooth, c.clearance, c.back, c.near_edges]
        )
        run_rows(
            control, rows, *flat(rows, arrays), self._noise(observation), c.tick,
            np.array([c.speed_noise, c.turn_noise]), c.temperature, c.control_cost, c.margin,
            weights, new,
        )  # fmt: skip
        plan = new.reshape(plan.shape)
        self._table.write("plan", observation.rows, plan)
        twist = plan[:, :, 0].copy()
        steering = steering_after(twist, steering, limits)
        self._table.write("steering", observation.rows, steering)
        return twist

    def _noise(self, observation: Observation) -> FloatArray:
        """Draw standard normals (B·A, S, M, 2), each active agent's from its own stream."""
        worlds, agents = observation.active.shape
        noise = np.zeros((worlds, agents, self.config.samples, self.config.knots, 2))
        for world, agent in np.argwhere(observation.active):
            stream = self._streams[int(observation.rows[world])][agent]
            stream.standard_normal(out=noise[world, agent])
        return noise.reshape(worlds * agents, *noise.shape[2:])
