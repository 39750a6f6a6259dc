"""The error that ends tests/bench/instructions, and the checks that cause it."""

import os
import re
import shutil


class Refusal(Exception):
    """The message is one line: the file or the program, the error, and the remedy."""


def require_file(path, remedy):
    """Raises Refusal if the file is missing or cannot be read."""
    try:
        with open(path, "rb"):
            pass
    except OSError as error:
        raise Refusal(f"{path}: {error.strerror}; {remedy}") from error


def require_program(name, package):
    if not shutil.which(name):
        raise Refusal(f"{name}: the program is missing; install the package {package}")


def message_of_end(process, name, errors):
    """Waits for the end of an emulator, and returns a line about it. `errors`: the file with its standard error."""
    status = process.wait()
    errors.seek(0, os.SEEK_SET)
    lines = errors.read().decode(errors="replace").splitlines()
    why = [line for line in lines if re.match(r"qemu[\w-]*: (?!warning)", line)]  # QEMU also prints registers
    how = f"signal {-status}" if status < 0 else f"status {status}"
    cause = f": {why[0].removeprefix(name + ': ')}" if why else ""
    return f"{name}: the emulator has ended with {how}{cause}; remove the cause and start it again"
