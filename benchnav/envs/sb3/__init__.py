"""Environments and learners for Stable-Baselines3."""
