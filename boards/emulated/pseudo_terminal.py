"""A pseudo-terminal that masters open and close like a serial port.

QEMU can create a pseudo-terminal itself, but only checks from time to time whether a master has opened this terminal.
Until QEMU detects a new master, it discards the bytes that the module sends.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import pty
import select
import termios
import tty
from pathlib import Path

from emulated.refusal import Refusal

_IN_CLOSE_WRITE, _IN_CLOSE_NOWRITE, _IN_OPEN = 0x08, 0x10, 0x20


class PseudoTerminal:
    """A pseudo-terminal in raw mode.

    A master is a program that opens the terminal like a serial port. The attribute `master` is not such a
    program. It is a descriptor, through which this class reads and writes the bytes.

    As on a real line, bytes from the module are lost if no master has the terminal open. Bytes from the module that no
    master has read are lost when the last master closes the terminal.
    """

    def __init__(self) -> None:
        self.master, slave = pty.openpty()
        tty.setraw(slave)
        self.device = os.ttyname(slave)
        os.close(slave)
        os.set_blocking(self.master, False)
        self.open_events = _watch(self.device)
        self._written = False  # whether the terminal may contain unread bytes from the module
        self._link: Path | None = None

    def check_link(self, path: Path) -> None:
        """Raises the Refusal of `link`. Leaves no link, but removes a stale one."""
        self.link(path)
        self.unlink()
        self._link = None

    def link(self, path: Path) -> None:
        """Creates a symbolic link to the terminal. Replaces a stale link, which a killed run may have left.

        Raises Refusal if anything else is at the path, or if the link cannot be created.
        """
        try:
            if path.is_symlink() and _is_stale(path, self.device):
                path.unlink()
            path.symlink_to(self.device)
        except FileExistsError as error:
            raise Refusal(f"--link {path}: the path exists already; remove it or name another path") from error
        except OSError as error:
            raise Refusal(f"--link {path}: {error.strerror}; name a path that can be written") from error
        self._link = path

    def unlink(self) -> None:
        """Removes the link if it still points to this terminal."""
        if self._link is not None and self._link.is_symlink() and os.readlink(self._link) == self.device:
            self._link.unlink()

    def is_opened(self) -> bool:
        """Returns whether at least one master has the terminal open."""
        poll = select.poll()
        poll.register(self.master, 0)
        return not poll.poll(0)  # poll reports a hang-up if no master has the terminal open

    def process_open_events(self) -> None:
        """Processes the events of masters that open or close the terminal. Call this when `open_events` is readable."""
        with contextlib.suppress(BlockingIOError):
            while os.read(self.open_events, 4096):
                pass
        if self._written and not self.is_opened():
            self._forget_unread()

    def _forget_unread(self) -> None:
        """Discards unread bytes from the module, so that the next master does not receive a reply to another master.

        Call this immediately after the last master has closed the terminal, because the next master may read as soon as
        it has opened the terminal.
        """
        self._written = False
        slave = os.open(self.device, os.O_RDWR | os.O_NOCTTY | os.O_CLOEXEC)
        termios.tcflush(slave, termios.TCIFLUSH)
        os.close(slave)

    def read(self) -> bytes:
        """Returns at most 4096 bytes that masters have written, even if these masters have closed the terminal. Returns
        an empty result if there are no bytes."""
        try:
            return os.read(self.master, 4096)
        except OSError:
            return b""

    def write(self, data: bytes) -> None:
        """Writes bytes to the terminal without waiting. Bytes are lost if no master has the terminal open, or if no
        master reads and the buffers of the kernel are full."""
        if self.is_opened():
            self._written = True
            with contextlib.suppress(BlockingIOError):
                os.write(self.master, data)


def _watch(device: str) -> int:
    """Returns an inotify descriptor that is readable after a program has opened or closed `device`. Raises Refusal if
    `device` cannot be watched. Uses libc, because the standard library of Python has no functions for inotify."""
    libc = ctypes.CDLL(None, use_errno=True)
    descriptor = int(libc.inotify_init1(os.O_NONBLOCK | os.O_CLOEXEC))
    events = _IN_OPEN | _IN_CLOSE_WRITE | _IN_CLOSE_NOWRITE
    if descriptor < 0 or libc.inotify_add_watch(descriptor, os.fsencode(device), events) < 0:
        reason = os.strerror(ctypes.get_errno())
        raise Refusal(f"{device}: cannot be watched: {reason}; end other programs that use inotify")
    return descriptor


def _is_stale(link: Path, own_device: str) -> bool:
    """Returns whether the link points to a terminal that no longer exists, or to `own_device`. If the link points
    to `own_device`, an earlier terminal had the same name."""
    target = os.readlink(link)
    return target.startswith("/dev/pts/") and (target == own_device or not os.path.exists(target))
