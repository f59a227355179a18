"""A report of runs: a folder of pages that opens from disk and can be published."""
