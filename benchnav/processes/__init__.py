"""Processes in which code of strangers runs: how they start, what they say, and their end."""
