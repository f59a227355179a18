"""62 numbers as the paper's, with nearness in place of lengths and whole velocities of movers.

The same objects, measured on a scale on which close things differ most: the numbers that decide
about a collision vary by about 1 where lengths over 8 m vary by 0.1. The flag for no object, which
the others imply, makes room for the speed of a mover across the ray: without it, a mover that
crosses looks like one that stands. A policy learns from them several times faster
(docs/results/policy-failures.md).
"""

from typing import ClassVar

import numpy as np

from benchnav.arrays import FloatArray
from benchnav.envs.encoders.encoder import Bodies, Number
from benchnav.envs.encoders.paper import SPAN, SPEED, EgoEncoder, own_frame
from benchnav.navigation.observation import Observation

FADES = (1.0, 4.0)  # [m] distances over which a part of the nearness falls by the factor e
GOAL_FADE = 2.0  # [m]


class NearEncoder(EgoEncoder):
    """The numbers of `EgoEncoder`: nearness of what the rays meet; nearness and bearing of goal."""

    name: ClassVar[str] = "near"
    fades: ClassVar[FloatArray] = np.array(FADES)

    def _own_numbers(self) -> tuple[Number, ...]:
        return (
            Number("goal.near", "m", 0, 1, f"exp(-distance of the goal / {GOAL_FADE:g} m)"),
            Number("goal.distance", "m", 0, 3, f"distance of the goal over {SPAN:g} m"),
            Number("v_a.ahead", "m/s", -1.5, 1.5, f"own velocity ahead over {SPEED:g} m/s"),
            Number("v_a.left", "m/s", -1.5, 1.5, f"own velocity to the left over {SPEED:g} m/s"),
            Number("goal.cos", "", -1, 1, "cosine of the goal's bearing"),
            Number("goal.sin", "", -1, 1, "sine of the goal's bearing"),
        )

    def _own_values(self, seen: Observation, bodies: Bodies) -> FloatArray:
        distance = np.linalg.norm(seen.goal - seen.position, axis=-1)[..., None]
        goal = [np.exp(-distance / GOAL_FADE), distance / SPAN]
        return np.concatenate([*goal, own_frame(seen)[..., 2:]], axis=-1)

    def _fifth_number(self, ray: int) -> Number:
        what = f"speed of the mover that it meets across the ray, to its left, over {SPEED:g} m/s"
        return Number(f"ray{ray}.mover_across", "m/s", -1.5, 1.5, what)

    def _length_number(self, name: str, what: str) -> Number:
        parts = " + ".join(f"exp(-d / {fade:g} m)" for fade in FADES)
        return Number(name, "m", 0, len(FADES), f"{parts} for d, {what}; 0 if none")
