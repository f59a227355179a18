"""Tested definitions of how well an episode went."""
