"""What a drawn world is made of: solids, bodies, agents, clock and rules."""
