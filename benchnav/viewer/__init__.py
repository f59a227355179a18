"""Pictures of results: paired comparisons and curves. They need the extra ``view``."""
