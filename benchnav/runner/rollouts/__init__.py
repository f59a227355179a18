"""Rollouts: one navigator in many worlds, and the record of each episode."""
