"""The exception for errors that the user can fix."""


class Refusal(Exception):
    """An error that the user can fix. Its one-line message names the argument or program, the error, and the remedy."""
