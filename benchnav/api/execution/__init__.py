"""Functions that do the work: run a suite, simulate, train, make an environment."""
