"""The execution of tasks on a Ray cluster."""
