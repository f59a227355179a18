"""What agents may perceive."""
