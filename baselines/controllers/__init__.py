"""Local controllers."""
