"""Search on an occupancy grid: A*, and any-angle Theta*."""
