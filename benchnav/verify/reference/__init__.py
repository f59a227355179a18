"""Independent second implementations that verification compares with."""
