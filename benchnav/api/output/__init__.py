"""Text, messages and progress that the Python API shows."""
