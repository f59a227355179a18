"""A touch in the reference simulator, and whether rounding may decide which comes first."""

from dataclasses import dataclass

from benchnav.verify.reference.reference_contacts import Partner

CLOSE = 1e-9  # [s] touches closer in time than this may come in either order


@dataclass
class Touch:
    """The next touch of an agent."""

    time: float  # [s] from now
    agent: int
    partner: Partner
    capsule: int = -1  # of the solid


def rivals(best: Touch, found: list[Touch]) -> bool:
    """Whether another touch, with one of the same two agents, could come first as well."""
    own = {best.agent, best.partner[1] if best.partner[0] == "agent" else best.agent}
    for other in found:
        others = {other.agent, other.partner[1] if other.partner[0] == "agent" else other.agent}
        close = other is not best and other.time - best.time < CLOSE and others != own
        if close and own & others:
            return True
    return False
