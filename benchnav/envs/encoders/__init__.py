"""Observations as vectors of numbers for a learner, made of the benchmark's own sensors."""
