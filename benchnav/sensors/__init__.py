"""The sensors of agents."""
