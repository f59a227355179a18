"""Quantities that several metrics share."""
