"""The exception for errors that the user can fix."""


class Refusal(Exception):
    """An error that the user can fix. Its message is one line: what the error concerns (for example an argument or a
    program), the error, and the remedy."""
