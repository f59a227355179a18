"""Objects of the Python API: a run, its tables, a scenario, a world and an episode."""
