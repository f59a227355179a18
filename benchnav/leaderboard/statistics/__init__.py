"""Estimates, intervals, paired comparisons and rankings."""
