"""The parts of a drawn world: solids, bodies, agents, clock and rules."""
