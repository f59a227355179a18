"""The pages of a report: each module has a function `pages` that yields them."""
