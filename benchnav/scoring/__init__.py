"""Metrics of trajectories that other programs recorded or simulated."""
