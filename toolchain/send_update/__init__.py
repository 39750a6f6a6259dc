"""Sends an update file to modules over the line."""
