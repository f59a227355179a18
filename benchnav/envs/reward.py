"""The reward of the paper, Eq. 2–10, term by term.

Weights are magnitudes; Eq. 2 subtracts the penalties. Approach, time, turning and the
penalty for p > T_c apply to every decision, the others to every event.
"""

from dataclasses import dataclass, fields
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from benchnav.arena.solid import Kind
from benchnav.arrays import BoolArray, FloatArray, IntArray


class RewardWeights(BaseModel):
    """Magnitudes of the weights. docs/learning.md explains the interpretation of Table 1."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    goal: float = Field(100.0, ge=0, description="w_goal, on touching the goal disc (Eq. 3)")
    approach: float = Field(1.0, ge=0, description="w_approach, per decision (Eq. 4)")
    static: float = Field(20.0, ge=0, description="w_c_static, per new contact (Eq. 5)")
    dynamic: float = Field(20.0, ge=0, description="w_c_dynamic, per new contact (Eq. 6)")
    walls: float = Field(20.0, ge=0, description="w_c_walls, per new contact (Eq. 7)")
    agents: float = Field(20.0, ge=0, description="w_c_agents, per new contact (Eq. 8)")
    time: float = Field(1.0, ge=0, description="w_time, per decision (Eq. 9)")
    p_dynamic: float = Field(4.0, ge=0, description="w_p_dynamic, per decision, p > T_c (Eq. 10)")
    threshold: float = Field(0.6, ge=0, le=1, description="T_c")
    moving: Literal["sign", "progress"] = Field(
        "sign",
        description="reward of approach: in full for any approach (Eq. 4 as printed), or by share"
        " of the way at full speed (negative for an increase of the distance)",
    )
    turning: float = Field(
        0.0, ge=0, description="not in the paper: per decision at full turn rate, else its share"
    )
    scale: float = Field(0.01, gt=0, description="factor of the total reward")


@dataclass(frozen=True, eq=False)
class RewardTerms:
    """(B, A) each, with their signs in Eq. 2, before scaling."""

    goal: FloatArray
    approach: FloatArray
    static: FloatArray
    dynamic: FloatArray
    walls: FloatArray
    agents: FloatArray
    time: FloatArray
    p_dynamic: FloatArray
    turning: FloatArray

    @property
    def total(self) -> FloatArray:
        """(B, A) Eq. 2."""
        total = np.zeros_like(self.goal)
        for f in fields(self):
            total += getattr(self, f.name)
        return total


def reward_terms(
    weights: RewardWeights,
    *,
    arrived: BoolArray,
    nearer: FloatArray,
    contacts: IntArray,
    probability: FloatArray,
    turned: FloatArray,
) -> RewardTerms:
    """Return every term of one decision.

    Args:
        weights: magnitudes.
        arrived: (B, A) touched the goal within this decision.
        nearer: (B, A) decrease of the distance to the goal over that at full speed, ≤ 1.
        contacts: (B, A, kinds) new contacts by Kind.
        probability: (B, A) Eq. 24 after the decision.
        turned: (B, A) |turn rate| over its limit, 0 to 1.
    """
    w = weights
    calm = probability <= w.threshold
    toward = nearer if w.moving == "progress" else (nearer > 0.0).astype(float)

    def hits(kind: Kind, weight: float) -> FloatArray:
        return -weight * contacts[..., int(kind)].astype(float)

    return RewardTerms(
        goal=w.goal * (arrived & calm).astype(np.float64),
        approach=np.where(calm, w.approach * toward, np.minimum(w.approach * toward, 0.0)),
        static=hits(Kind.STATIC, w.static),
        dynamic=hits(Kind.DYNAMIC, w.dynamic),
        walls=hits(Kind.WALL, w.walls),
        agents=hits(Kind.AGENT, w.agents),
        time=np.full(arrived.shape, -w.time),
        p_dynamic=-w.p_dynamic * (~calm).astype(float),
        turning=-w.turning * turned,
    )
