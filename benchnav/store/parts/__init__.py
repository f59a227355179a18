"""Parts of a run: episodes, results and their seal."""
