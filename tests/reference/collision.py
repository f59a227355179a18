"""The collision probability, slow and obvious: where the ray meets the circle, by polynomial."""

import numpy as np

from benchnav.arena.solid import Kind


def probability(offset, velocity, reach):
    """Of a mover at ``offset`` from the agent, approached at ``velocity``."""
    if np.hypot(*offset) <= reach:
        return 1.0
    # |velocity t - offset|^2 = reach^2
    polynomial = [velocity @ velocity, -2 * velocity @ offset, offset @ offset - reach**2]
    if polynomial[0] < 1e-18:
        return 0.0
    roots = np.roots(polynomial)
    ahead = [root.real for root in roots if abs(root.imag) < 1e-12 and root.real >= 0]
    return min(1.0, 1.0 / min(ahead)) if ahead else 0.0


def highest(position, velocity, radius, seen):
    """(B, A) over the movers that each agent sees."""
    out = np.zeros(position.shape[:2])
    for b, a in np.ndindex(*out.shape):
        for k in range(seen.count[b, a]):
            if seen.kind[b, a, k] == Kind.DYNAMIC:
                p = probability(
                    seen.position[b, a, k] - position[b, a],
                    velocity[b, a] - seen.velocity[b, a, k],
                    radius[b, a] + seen.radius[b, a, k],
                )
                out[b, a] = max(out[b, a], p)
    return out
