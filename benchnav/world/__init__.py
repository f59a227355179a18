"""Drawing worlds and stepping them in batches."""
