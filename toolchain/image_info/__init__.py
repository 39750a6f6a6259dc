"""Reads the information that a firmware image contains about itself."""
