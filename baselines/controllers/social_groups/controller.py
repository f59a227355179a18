"""The social force model with groups, and with people who stop."""

import math
from collections.abc import Sequence
from typing import Annotated

import numpy as np
from pydantic import Field, field_validator

from benchnav.arrays import FloatArray, IntArray
from benchnav.navigation import Briefing, Guide, Observation, PluginConfig
from benchnav.threads import run_rows

from ...common.kernel_inputs import bodies_of, flat
from ..social_force.controller import SocialForce, SocialForceConfig
from .groups import MOST_STOPS, companions_of, draw_changes, form_groups, standing
from .kernel import GroupForces, group_force

MOST_MEMBERS = 12
Share = Annotated[float, Field(ge=0)]


class SocialGroupsConfig(SocialForceConfig):
    """Parameters of the model; values of the two papers unless noted."""

    group_sizes: tuple[Share, ...] = Field(
        (0.64, 0.27, 0.07, 0.02),
        min_length=1,
        max_length=MOST_MEMBERS,
        description="shares of groups of 1, 2, 3, … members; `[1]`: all walk alone",
    )
    group_reach: float = Field(
        3.0,
        gt=0,
        description="[m] within which starts, and goals, of a group are (not from the paper)",
    )
    gaze: float = Field(
        4.0, ge=0, description="[1/s] β₁, of slowing down by angle of the turned head"
    )
    attraction: float = Field(3.0, ge=0, description="[m/s²] β₂, to the centre of the group")
    repulsion: float = Field(1.0, ge=0, description="[m/s²] β₃, from each member that is too near")
    view_angle: float = Field(
        0.5 * math.pi,
        ge=0,
        le=math.pi,
        description="[rad] φ, to each side without a turn of the head",
    )
    group_spacing: float = Field(
        1.0,
        ge=0,
        description="[m] attraction begins at (N - 1) / 2 times this distance from the centre",
    )
    attraction_ramp: float = Field(
        0.5, gt=0, description="[m] over which it grows to its strength (not from the paper)"
    )
    member_distance: float = Field(
        0.8, ge=0, description="[m] d₀, between centres, below which members repel each other"
    )
    stop_every: float | None = Field(
        None,
        gt=0,
        description="[s] mean time that a group walks before it stops; none: it never stops"
        f" (not from the papers; at most {MOST_STOPS} stops)",
    )
    stop_for: float = Field(
        10.0, gt=0, description="[s] mean duration of a stop (not from the papers)"
    )

    @field_validator("group_sizes")
    @classmethod
    def _check_group_sizes(cls, shares: tuple[float, ...]) -> tuple[float, ...]:
        if not any(shares):
            raise ValueError("must have a share above 0")
        return shares


class SocialGroups(SocialForce):
    """The social force model in which some agents walk in groups and stop together."""

    Config = SocialGroupsConfig

    def __init__(self, config: PluginConfig | None = None) -> None:
        super().__init__(config)
        c = self.config
        self.groups: dict[int, list[IntArray]] = {}  # row → agents of each group
        self._group_forces = GroupForces(
            gaze=c.gaze, attraction=c.attraction, repulsion=c.repulsion, view_angle=c.view_angle,
            spacing=c.group_spacing, ramp=c.attraction_ramp, distance=c.member_distance,
        )  # fmt: skip

    def reset(self, briefings: Sequence[Briefing], rows: IntArray) -> None:
        super().reset(briefings, rows)
        c = self.config
        for row, briefing in zip(rows.tolist(), briefings, strict=True):
            groups = form_groups(briefing, c.group_sizes, c.group_reach)
            body = bodies_of(briefing)
            changes = np.full((len(briefing), 2 * MOST_STOPS), np.inf)
            for group in groups:
                body[group, 2] = body[group, 2].mean()  # preferred speed
                if c.stop_every is not None:
                    changes[group] = draw_changes(c.stop_every, c.stop_for, briefing.rng)
            self.groups[row] = groups
            companions = companions_of(groups, len(briefing), max(len(c.group_sizes) - 1, 1))
            self._table.put(row, body=body, companions=companions, changes=changes)

    def steer(self, observation: Observation, guide: Guide) -> FloatArray:
        shape = observation.active.shape
        body, push, companions = (
            self._table.take(name, observation.rows, shape[1])
            for name in ("body", "push", "companions")
        )
        rows, force = shape[0] * shape[1], push.reshape(-1, 2).copy()
        arrays = (observation.active, observation.position, observation.velocity, companions)
        run_rows(group_force, rows, shape[1], *flat(rows, arrays), self._group_forces, force)
        target = guide.target
        if self.config.stop_every is not None:
            changes = self._table.take("changes", observation.rows, shape[1])
            stands = standing(changes, observation.time)
            target = np.where(stands[..., None], observation.position, target)
        return self._velocity(observation, target, body, force.reshape(*shape, 2))
