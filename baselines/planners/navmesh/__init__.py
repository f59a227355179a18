"""A navigation mesh: triangles of free space, a search over their sides, and the funnel algorithm."""
