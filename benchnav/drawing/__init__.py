"""Pictures of worlds that need no plotting library."""
