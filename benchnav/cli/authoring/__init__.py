"""Commands for authors of scenarios and plugins."""
