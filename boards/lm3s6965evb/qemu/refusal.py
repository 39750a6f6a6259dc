"""What cannot be done, in one line for people."""


class Refusal(Exception):
    """Says which argument or program is meant, what is wrong with it, and what helps."""
