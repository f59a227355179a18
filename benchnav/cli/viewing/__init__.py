"""Commands that show what is installed."""
