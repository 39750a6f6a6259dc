"""The contents of a memory chip, in a file or in RAM of the host."""

from __future__ import annotations

import fcntl
import os
from pathlib import Path

from emulated.refusal import Refusal

_BLANK = b"\xff"


def in_memory(size: int, content: bytes = b"") -> int:
    """Creates a memory of `size` bytes in RAM of the host, and returns its descriptor. The memory begins with
    `content`, and its other bytes are blank. It exists until its last descriptor is closed."""
    descriptor = os.memfd_create("memory")
    os.write(descriptor, content + _BLANK * (size - len(content)))
    return descriptor


def in_file(option: str, path: Path, size: int) -> int:
    """Locks a memory file, so that no other run and no simulator can use this file, and returns the descriptor of the
    file. Creates a missing file, and fills a new or empty file with `size` blank bytes.

    Raises Refusal if the file cannot be opened for reading and writing, is locked, or is not empty and does not have
    `size` bytes. The message begins with `option`, the command-line option that names the file.
    """
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
    except OSError as error:
        raise Refusal(f"{option} {path}: {error.strerror}; name a file that can be written") from error
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        raise Refusal(
            f"{option} {path}: another program uses this file; end that program or name another file"
        ) from error
    found = os.fstat(descriptor).st_size
    if found == 0:
        os.write(descriptor, _BLANK * size)
    elif found != size:
        raise Refusal(
            f"{option} {path}: the file has {found} bytes instead of {size}; name another file or remove this one"
        )
    return descriptor
