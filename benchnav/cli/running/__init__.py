"""Commands that make, change or check runs and weights."""
