"""The execution of tasks in local processes, and the measurement of their episodes."""
