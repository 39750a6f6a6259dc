"""Reads what a firmware image says about itself."""
