"""The dynamic window approach (Fox, Burgard & Thrun 1997)."""
