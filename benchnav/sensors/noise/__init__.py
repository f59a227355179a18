"""Errors of the senses, drawn by a hash of world, agent, decision and channel."""
