"""Text for people: plurals and safe printing."""
