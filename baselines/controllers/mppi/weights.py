"""The information-theoretic part: weights of samples, and the free energy that they bound.

Williams, Wagener, Goldfain, Drews, Rehg, Boots and Theodorou 2017, "Information theoretic
MPC for model-based reinforcement learning", ICRA: Eqs. 4–6 (free energy), Algorithm 2 (weights).
"""

import math

from benchnav.arrays import FloatArray
from benchnav.kernels import kernel


@kernel
def weigh(cost: FloatArray, temperature: float, out: FloatArray) -> float:
    """Fill ``out`` (K,) with exp(−cost / λ) / Σ; return −λ log mean exp(−cost / λ).

    The result is the free energy; λ is ``temperature``. If it falls to 0, the best sample gets all
    weight, and the free energy falls to its cost; if it rises, weights become equal and the free
    energy approaches the mean cost.
    """
    least = cost[0]
    for k in range(len(cost)):
        least = min(least, cost[k])
    total = 0.0
    for k in range(len(cost)):
        out[k] = math.exp((least - cost[k]) / temperature)
        total += out[k]
    for k in range(len(cost)):
        out[k] /= total
    free: float = least - temperature * math.log(total / len(cost))
    return free


@kernel
def moved_on(plan: FloatArray, share: float, out: FloatArray) -> None:
    """Set ``out`` (H, 2) to the plan (H, 2) advanced by ``share`` of a step; its end is held."""
    last = len(plan) - 1
    for t in range(len(plan)):
        at = min(t + share, float(last))
        k = min(int(at), last - 1) if last > 0 else 0
        f = at - k
        for c in range(2):
            out[t, c] = (1.0 - f) * plan[k, c] + f * plan[min(k + 1, last), c]


@kernel
def disturbed(
    plan: FloatArray, noise: FloatArray, spread: FloatArray, low: FloatArray, high: FloatArray,
    out: FloatArray,
) -> None:  # fmt: skip
    """Set ``out`` (H, 2) to the plan plus noise, within limits.

    The noise (M, 2), standard normal, is given at M knots and linear between them. This is an
    addition to the paper, whose noise is new at every step and makes the motion shaky.
    """
    steps, knots = len(plan), len(noise)
    for t in range(steps):
        at = t * (knots - 1) / (steps - 1) if steps > 1 else 0.0
        k = min(int(at), knots - 2)
        f = at - k
        for c in range(2):
            e = spread[c] * ((1.0 - f) * noise[k, c] + f * noise[k + 1, c])
            out[t, c] = min(max(plan[t, c] + e, low[c]), high[c])
