"""A navigation mesh: triangles of free space, a search over their sides, and a taut string."""
