"""The source code of plugins under test: found and hashed without importing it."""
