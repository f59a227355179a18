"""Sampling-based planners of the Open Motion Planning Library."""
