"""Optimal reciprocal collision avoidance (van den Berg et al. 2011)."""
