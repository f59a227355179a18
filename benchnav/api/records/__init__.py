"""Handles on stored and drawn records: a run, its tables, a scenario, a world, an episode."""
