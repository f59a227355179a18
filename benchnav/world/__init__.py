"""Draw worlds from scenarios, and step them in batches."""
