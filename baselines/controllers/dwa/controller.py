"""The dynamic window approach towards the guide's target."""

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
)
from benchnav.threads import run_rows

from ...common.backing import Backing
from ...common.kernel_inputs import bodies_of, flat, sensed
from ...common.motion_limits import has_limits, limits_of, steering_after
from .kernel import Search, choose


class DynamicWindowConfig(PluginConfig):
    """Parameters of the dynamic window approach."""

    acceleration: float = Field(
        10.0,
        gt=0,
        description="[m/s²] largest acceleration and deceleration; less if the body's are less",
    )
    turn_acceleration: float = Field(
        20.0,
        gt=0,
        description="[rad/s²] largest change of the turn rate; less if the body's is less",
    )
    heading: float = Field(0.8, ge=0, description="α, weight of the direction to the target")
    distance: float = Field(3.0, ge=0, description="β, weight of the free distance")
    speed: float = Field(0.2, ge=0, description="γ, weight of driving fast")
    far: float = Field(1.0, gt=0, description="[m] longer free distances count the same")
    margin: float = Field(0.06, ge=0, description="[m] smallest gap to any object")
    predict: bool = Field(
        True,
        description="whether neighbours keep their velocities; false: they stand still, as in"
        " the paper",
    )
    horizon: float = Field(3.0, gt=0, description="[s] of prediction")
    hold: float = Field(
        0.6,
        gt=0,
        description="[s] after which a turning agent is predicted to keep its course, when"
        " neighbours are predicted (not from the paper)",
    )
    speeds: int = Field(6, ge=2, description="number of speeds in the window")
    turns: int = Field(15, ge=2, description="number of turn rates in the window")


class DynamicWindow(Controller):
    """Drives the best arc that is reachable within a step and allows a stop before obstacles.

    It commands twists, so that the checked motion is the executed one; holonomic bodies follow
    twists too. The window holds what the body can execute within a step: its accelerations, the
    speeds of its wheels, and the steering of a car, which tries curves instead of turns on the
    spot. A body that can drive backwards tries that too; a car that stands for a second does so.
    """

    Config = DynamicWindowConfig
    needs: ClassVar[frozenset[Need]] = frozenset({Need.NEIGHBOURS, Need.EDGES})
    command: ClassVar[CommandKind] = "twist"

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        self._table = RowTable()
        self._backing = Backing()
        c = self.config
        self._search = Search(
            acceleration=c.acceleration, turn_acceleration=c.turn_acceleration, heading=c.heading,
            distance=c.distance, speed=c.speed, margin=c.margin, far=c.far, horizon=c.horizon,
            hold=c.hold, predict=c.predict, speeds=c.speeds, turns=c.turns,
        )  # fmt: skip

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        self._backing.reset(briefings, rows)
        for row, briefing in zip(rows, briefings, strict=True):
            limits = limits_of(briefing)
            self._table.put(
                int(row), body=bodies_of(briefing), limits=limits, limited=has_limits(limits),
                last=np.zeros((len(briefing), 3)),
            )  # fmt: skip

    def steer(self, observation: Observation, guide: Guide) -> FloatArray:
        worlds, agents = observation.active.shape
        rows = worlds * agents
        body, last, limits, limited = (
            self._table.take(name, observation.rows, agents)
            for name in ("body", "last", "limits", "limited")
        )
        moving = np.sqrt(np.sum(observation.velocity**2, axis=-1))
        # the limits of a body hold for its last command, also after a contact
        now = np.where(limited, last[..., 0], moving)
        backing = self._backing.decide(observation, last[..., 0])
        position, velocity, radius, _, count, start, end, _, _, edges = sensed(observation)
        arrays = (
            observation.active, observation.position, observation.heading,
            np.concatenate([now[..., None], last[..., 1:]], axis=-1), guide.target,
            guide.remaining, body, limited, limits, backing, position, velocity, radius, count,
            start, end, edges,
        )  # fmt: skip
        answer = np.zeros((rows, 2))
        run_rows(choose, rows, *flat(rows, arrays), self._search, answer)
        twist = answer.reshape(worlds, agents, 2)
        steering = steering_after(twist, last[..., 2], limits)
        now = np.concatenate([twist, steering[..., None]], axis=-1)
        self._table.write("last", observation.rows, now)
        return twist
