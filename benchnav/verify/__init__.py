"""The verification of stored runs."""
