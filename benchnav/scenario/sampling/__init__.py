"""Distributions of numbers, and regions that points are drawn from."""
