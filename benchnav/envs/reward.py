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
from benchnav.kernels import kernel_without_allocation


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

    @property
    def vector(self) -> FloatArray:
        """(11,) all numbers, in the order of their declaration, for the kernel.

        It is not cached: a copy of a model with changes copies caches too.
        """
        return np.array((
            self.goal, self.approach, self.static, self.dynamic, self.walls, self.agents, self.time,
            self.p_dynamic, self.threshold, self.turning, self.scale,
        ))  # fmt: skip


(
    _GOAL, _APPROACH, _STATIC, _DYNAMIC, _WALLS, _AGENTS, _TIME, _P_DYNAMIC, _THRESHOLD, _TURNING,
    _SCALE,
) = range(11)  # fmt: skip
_STATIC_KIND, _DYNAMIC_KIND = int(Kind.STATIC), int(Kind.DYNAMIC)
_WALL_KIND, _AGENT_KIND = int(Kind.WALL), int(Kind.AGENT)


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


TERMS = tuple(f.name for f in fields(RewardTerms))


def reward_of(
    weights: RewardWeights,
    *,
    acted: BoolArray,
    arrived: BoolArray,
    nearer: FloatArray,
    contacts: IntArray,
    probability: FloatArray,
    turned: FloatArray,
) -> tuple[RewardTerms, FloatArray]:
    """Return every term of one decision, and the scaled reward (B, A), 0 if there was no decision.

    Args:
        weights: magnitudes.
        acted: (B, A) whether there was a decision.
        arrived: (B, A) touched the goal within this decision.
        nearer: (B, A) decrease of the distance to the goal over that at full speed, ≤ 1.
        contacts: (B, A, kinds) new contacts by Kind.
        probability: (B, A) Eq. 24 after the decision.
        turned: (B, A) |turn rate| over its limit, 0 to 1.
    """
    terms = np.empty((len(TERMS), *arrived.shape))
    reward = np.empty(arrived.shape)
    _write_terms(
        weights.vector, weights.moving == "progress", acted, arrived, nearer, contacts, probability,
        turned, terms, reward,
    )  # fmt: skip
    return RewardTerms(*terms), reward


@kernel_without_allocation
def _write_terms(
    weights: FloatArray, progress: bool, acted: BoolArray, arrived: BoolArray, nearer: FloatArray,
    contacts: IntArray, probability: FloatArray, turned: FloatArray, terms: FloatArray,
    reward: FloatArray,
) -> None:  # fmt: skip
    for b in range(arrived.shape[0]):
        for i in range(arrived.shape[1]):
            term, hits = terms[:, b, i], contacts[b, i]
            calm = probability[b, i] <= weights[_THRESHOLD]
            toward = nearer[b, i] if progress else 1.0 if nearer[b, i] > 0.0 else 0.0
            approach = weights[_APPROACH] * toward
            term[0] = weights[_GOAL] if arrived[b, i] and calm else 0.0
            term[1] = approach if calm or approach < 0.0 else 0.0
            term[2] = -weights[_STATIC] * float(hits[_STATIC_KIND])
            term[3] = -weights[_DYNAMIC] * float(hits[_DYNAMIC_KIND])
            term[4] = -weights[_WALLS] * float(hits[_WALL_KIND])
            term[5] = -weights[_AGENTS] * float(hits[_AGENT_KIND])
            term[6] = -weights[_TIME]
            term[7] = -weights[_P_DYNAMIC] * (0.0 if calm else 1.0)
            term[8] = -weights[_TURNING] * turned[b, i]
            total = 0.0
            for k in range(len(term)):
                total += term[k]
            reward[b, i] = weights[_SCALE] * total if acted[b, i] else 0.0
