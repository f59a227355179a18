"""The undisturbed world: a drawn world without its evaluated agents, to measure their effect."""

from dataclasses import fields, replace

import numpy as np

from benchnav.arena.agents import Agents
from benchnav.arena.world import World


def undisturbed_world(world: World) -> World:
    """Return ``world`` without its evaluated agents; all others keep their order.

    Background driver k becomes driver k - 1, so the first background navigator is the evaluated
    one there: an episode needs one, and lasts until all of its agents arrive, at most.
    """
    others = np.flatnonzero(~world.agents.evaluated)
    columns = {f.name: getattr(world.agents, f.name)[others] for f in fields(Agents)}
    return replace(world, agents=Agents(**{**columns, "driver": columns["driver"] - 1}))
