"""A pseudo-terminal that masters open and close like a serial port.

QEMU can create a pseudo-terminal itself, but only checks from time to time whether a master has opened it. During the
first 0.7 s, a new master would lose the bytes that the module sends.
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

    As on a real line, bytes are lost if no master has opened it, or if a master closes it without reading them.
    """

    def __init__(self) -> None:
        self.master, slave = pty.openpty()
        tty.setraw(slave)
        self.device = os.ttyname(slave)
        os.close(slave)
        os.set_blocking(self.master, False)
        self.open_events = _watch(self.device)
        self._written = False  # whether the terminal may contain unread bytes
        self._link: Path | None = None

    def link(self, path: Path) -> None:
        """Creates a symbolic link to the terminal. Replaces a link that a killed run has left.

        Raises Refusal if anything else is at the path, or if the path cannot be written.
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
        """Returns whether a master has opened the terminal."""
        poll = select.poll()
        poll.register(self.master, 0)
        return not poll.poll(0)  # if no master has opened it, poll reports a hang-up

    def process_open_events(self) -> None:
        """Processes the events of masters that open or close the terminal. Call this when `open_events` is readable."""
        with contextlib.suppress(BlockingIOError):
            while os.read(self.open_events, 4096):
                pass
        if self._written and not self.is_opened():
            self._forget_unread()

    def _forget_unread(self) -> None:
        """Discards unread bytes, so that the next master does not get the reply to another master.

        Call this when the last master has closed the terminal: the next master may read as soon as it has opened the
        terminal.
        """
        self._written = False
        slave = os.open(self.device, os.O_RDWR | os.O_NOCTTY | os.O_CLOEXEC)
        termios.tcflush(slave, termios.TCIFLUSH)
        os.close(slave)

    def read(self) -> bytes:
        """Returns the bytes that masters have written, even if they have closed the terminal. May be empty."""
        try:
            return os.read(self.master, 4096)
        except OSError:  # there are no bytes, or no master has opened the terminal
            return b""

    def write(self, data: bytes) -> None:
        """Writes bytes to a master without waiting. If the master does not read, bytes after about 4 KiB are lost."""
        if self.is_opened():
            self._written = True
            with contextlib.suppress(BlockingIOError):
                os.write(self.master, data)


def _watch(device: str) -> int:
    """Returns an inotify descriptor for opening and closing `device`. Uses libc, because Python has no inotify."""
    libc = ctypes.CDLL(None, use_errno=True)
    descriptor = int(libc.inotify_init1(os.O_NONBLOCK | os.O_CLOEXEC))
    events = _IN_OPEN | _IN_CLOSE_WRITE | _IN_CLOSE_NOWRITE
    if descriptor < 0 or libc.inotify_add_watch(descriptor, os.fsencode(device), events) < 0:
        reason = os.strerror(ctypes.get_errno())
        raise Refusal(f"{device}: cannot be watched: {reason}; end other programs that use inotify")
    return descriptor


def _is_stale(link: Path, own_device: str) -> bool:
    """Returns whether the link points to a terminal that no longer exists, or to the new terminal by chance."""
    target = os.readlink(link)
    return target.startswith("/dev/pts/") and (target == own_device or not os.path.exists(target))
