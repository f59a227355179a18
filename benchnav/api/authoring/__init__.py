"""Functions for authors of scenarios and plugins."""
