"""Pure functions on arrays: no state, no randomness, no input or output."""
