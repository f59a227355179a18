"""A navigation mesh: triangles of free space, A* over their sides, funnel algorithm."""
