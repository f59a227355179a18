"""Random generators for navigators and agents."""
