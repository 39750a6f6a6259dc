"""The contents of the AT24C64, in a file or in memory."""

from __future__ import annotations

import fcntl
import os
from pathlib import Path

from qemu.refusal import Refusal

SIZE = 8192
_BLANK = b"\xff" * SIZE


def in_memory() -> int:
    """Returns the descriptor of a blank EEPROM in memory, which exists until the descriptor is closed."""
    descriptor = os.memfd_create("eeprom")
    os.write(descriptor, _BLANK)
    return descriptor


def in_file(path: Path) -> int:
    """Returns the descriptor of an EEPROM file and locks it against other runs. Creates a missing file, blank.

    Raises Refusal if the file cannot be written, is locked, or has the wrong size.
    """
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
    except OSError as error:
        raise Refusal(f"--eeprom {path}: {error.strerror}; name a file that can be written") from error
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        raise Refusal(f"--eeprom {path}: another run uses this file; end that run or name another file") from error
    size = os.fstat(descriptor).st_size
    if size == 0:
        os.write(descriptor, _BLANK)
    elif size != SIZE:
        raise Refusal(
            f"--eeprom {path}: the file has {size} bytes instead of {SIZE}; name another file or remove this one"
        )
    return descriptor
