"""Parses the arguments and passes bytes between a module in an emulator and a pseudo-terminal."""

from __future__ import annotations

import argparse
import contextlib
import os
import select
import signal
import sys
from pathlib import Path
from typing import Callable, Protocol

from emulated.pseudo_terminal import PseudoTerminal
from emulated.refusal import Refusal


class Ended(Exception):
    """The emulator has ended, or has reported an error. The message describes this event."""


class Machine(Protocol):
    """A module in an emulator."""

    watched: list[int]  # descriptors; if one is readable, `carry` has work

    @property
    def carry_within(self) -> float:
        """Returns the time in seconds within which `carry` must be called again."""

    def carry(self, requests: bytes, ready: list[int]) -> bytes:
        """Takes `requests`, the bytes from the master, and returns the bytes from the module. `ready` must contain the
        descriptors of `watched` that are readable. It may also contain descriptors that are not in `watched`.

        Does not wait for bytes of the master or of the module. Raises Ended if the emulator has ended or has
        reported an error.
        """

    def end(self) -> None:
        """Ends the emulator."""


def parser_for(emulator: str, preset: str) -> argparse.ArgumentParser:
    """Returns a parser for the arguments that all programs `run` have in common."""
    parser = argparse.ArgumentParser(
        prog="run",
        description=f"Runs a firmware image in {emulator}. The first line of the output is the path of the "
        "pseudo-terminal that is the module's RS-485 line. Press Ctrl-C or send SIGTERM to end the program.",
    )
    parser.add_argument("image", metavar="IMAGE.elf", type=Path, help=f"an image of the preset {preset}")
    parser.add_argument(
        "--link", metavar="PATH", type=Path, help="create a symbolic link to the pseudo-terminal"
    )
    parser.add_argument(
        "--init",
        action="store_true",
        help="tie INIT* to GND, so that the module uses ASCII, address 00 and 9600 baud",
    )
    return parser


def run(arguments: argparse.Namespace, emulator: str, start: Callable[[], Machine]) -> int:
    """Runs the machine that `start` returns, until a signal arrives, or until the machine raises Ended.

    Returns the exit status: 0 after a signal, 1 after Ended, 2 after a Refusal.
    """
    try:
        with contextlib.ExitStack() as at_the_end:
            signal_descriptor = _signal_descriptor()
            terminal = PseudoTerminal()
            if arguments.link:
                terminal.check_link(arguments.link)
            machine = start()
            at_the_end.callback(machine.end)
            if arguments.link:  # not earlier: a master may send its first request as soon as the link exists
                terminal.link(arguments.link)
                at_the_end.callback(terminal.unlink)
            print(terminal.device)
            print(f"{arguments.image.name} runs in {emulator}; press Ctrl-C to end", flush=True)
            _carry_bytes(machine, terminal, signal_descriptor)
    except Refusal as refusal:
        print(f"run: {refusal}", file=sys.stderr)
        return 2
    except Ended as ended:
        print(f"run: {ended}", file=sys.stderr)
        return 1
    return 0


def _signal_descriptor() -> int:
    """Returns a descriptor that becomes readable when SIGINT, SIGTERM or SIGHUP arrives and is not ignored."""
    readable, writable = os.pipe()
    os.set_blocking(writable, False)
    signal.set_wakeup_fd(writable)
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) != signal.SIG_IGN:  # nohup makes this program ignore SIGHUP
            signal.signal(number, lambda *_: None)
    return readable


def _carry_bytes(machine: Machine, terminal: PseudoTerminal, signal_descriptor: int) -> None:
    """Passes bytes until a signal arrives, or until `carry` raises Ended."""
    while True:
        watched = [signal_descriptor, terminal.open_events, *machine.watched]
        if terminal.is_opened():
            watched.append(terminal.master)
        ready, _, _ = select.select(watched, [], [], machine.carry_within)
        if signal_descriptor in ready:
            return
        if terminal.open_events in ready:
            terminal.process_open_events()
        # The terminal is read even if no master has it open, because a master may have written bytes and then closed
        # the terminal.
        terminal.write(machine.carry(terminal.read(), ready))
