"""Tables with honest statistics."""
