"""Rollouts, suites and their execution."""
