"""Checks the size, the worst-case stack and the contents of a firmware image, and how long it disables interrupts."""
