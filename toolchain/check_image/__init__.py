"""Checks size, worst-case stack and symbols of a firmware image."""
