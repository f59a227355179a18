"""Processes that run untrusted code: how they start, communicate and end."""
