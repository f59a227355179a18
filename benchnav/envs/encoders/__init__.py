"""Encoders: observations of the benchmark's sensors as vectors of numbers for a learner."""
