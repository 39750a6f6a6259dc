"""A pseudo-terminal that masters open and leave as they would a serial port.

QEMU can make one itself, but looks for a visitor only now and then, and what the module says to a new one in the
first 0.7 s is lost.
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

from qemu.refusal import Refusal

_IN_CLOSE_WRITE, _IN_CLOSE_NOWRITE, _IN_OPEN = 0x08, 0x10, 0x20


class PseudoTerminal:
    """Raw. What is sent while nobody is there is lost, as on a wire, and so is what a master leaves unread."""

    def __init__(self) -> None:
        self.master, slave = pty.openpty()
        tty.setraw(slave)
        self.device = os.ttyname(slave)
        os.close(slave)
        os.set_blocking(self.master, False)
        self.visits = _watch(self.device)
        self._written = False  # since it was last empty for sure
        self._link: Path | None = None

    def link(self, path: Path) -> None:
        """A symbolic link to it. One that a killed run has left is taken over."""
        try:
            if path.is_symlink() and _leads_nowhere(path, self.device):
                path.unlink()
            path.symlink_to(self.device)
        except FileExistsError as error:
            raise Refusal(f"--link {path}: something is there; remove it or name another path") from error
        except OSError as error:
            raise Refusal(f"--link {path}: {error.strerror}; name a path that can be written") from error
        self._link = path

    def unlink(self) -> None:
        """Removes the link, if it is still this one's."""
        if self._link is not None and self._link.is_symlink() and os.readlink(self._link) == self.device:
            self._link.unlink()

    def visited(self) -> bool:
        """Somebody has it open."""
        poll = select.poll()
        poll.register(self.master, 0)
        return not poll.poll(0)  # or it says that the other end is hung up

    def take_visits(self) -> None:
        """Whenever `visits` is readable: somebody has opened or closed it."""
        with contextlib.suppress(BlockingIOError):
            while os.read(self.visits, 4096):
                pass
        if self._written and not self.visited():
            self._forget_unread()

    def _forget_unread(self) -> None:
        """A reply to one master must not be the next one's first. Not when that one comes: it reads at once."""
        self._written = False
        slave = os.open(self.device, os.O_RDWR | os.O_NOCTTY | os.O_CLOEXEC)
        termios.tcflush(slave, termios.TCIFLUSH)
        os.close(slave)

    def read(self) -> bytes:
        """What masters have written, also one that has gone; empty: nothing."""
        try:
            return os.read(self.master, 4096)
        except OSError:  # nothing yet, or nobody there
            return b""

    def write(self, data: bytes) -> None:
        """Does not wait: who does not read loses what does not fit into the terminal, some 4 KiB."""
        if self.visited():
            self._written = True
            with contextlib.suppress(BlockingIOError):
                os.write(self.master, data)


def _watch(device: str) -> int:
    """Python has no inotify."""
    libc = ctypes.CDLL(None, use_errno=True)
    descriptor = int(libc.inotify_init1(os.O_NONBLOCK | os.O_CLOEXEC))
    events = _IN_OPEN | _IN_CLOSE_WRITE | _IN_CLOSE_NOWRITE
    if descriptor < 0 or libc.inotify_add_watch(descriptor, os.fsencode(device), events) < 0:
        raise Refusal(f"{device}: {os.strerror(ctypes.get_errno())}")
    return descriptor


def _leads_nowhere(link: Path, own_device: str) -> bool:
    """To a terminal that is gone, or whose number is the one just made."""
    target = os.readlink(link)
    return target.startswith("/dev/pts/") and (target == own_device or not os.path.exists(target))
