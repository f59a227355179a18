"""Commands that print tables and comparisons of runs."""
