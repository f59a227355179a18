"""The source of what is measured: found and hashed without importing it."""
