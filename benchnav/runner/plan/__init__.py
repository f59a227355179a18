"""The plan of a run: suites, contestants, jobs and tasks."""
