"""The command line of send-update."""

from __future__ import annotations

import argparse
import contextlib
import re
import sys
from pathlib import Path
from typing import Callable

import update_file
from send_update import modbus
from send_update.ports import FORMATS, PortError, serial_port, tcp_port
from send_update.progress import Progress
from send_update.update import Failed, Update

_RATES = (1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200)
_MODBUS_TCP = 502
_TCP = re.compile(r"(modbus-tcp|tcp):(\[[^]]+\]|[^]:[]+)(?::([0-9]+))?")
_INTERRUPTED = 130


def main(arguments: list[str]) -> int:
    options = _parse(arguments)
    try:
        file = update_file.parse(options.file.read_bytes())
        transport = _open(options)
        with contextlib.closing(transport.port):
            updates = [Update(modbus.Module(transport, module), file) for module in options.modules]
            return _Session(updates).run(options.wait)
    except update_file.NotAnUpdate as error:
        return _report(f"{options.file}: {error}")
    except OSError as error:
        return _report(f"{options.file}: {error.strerror}; name a file that you can read")
    except PortError as error:
        return _report(f"{options.port}: {error}")


def _report(problem: str) -> int:
    print(f"send-update: {problem}", file=sys.stderr)
    return 1


def _parse(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="send-update",
        description="Sends an update file to modules over the line. They keep working while they receive it, and start"
        " the new image together, when all have it. What a module has received stays: after an interruption, the same"
        " command continues.",
        epilog="examples: send-update /dev/ttyUSB0 EX9042D-M.ex9fw 5; send-update tcp:10.0.0.7:23"
        " EX9042D-M.ex9fw 1 2 0D001F3A --baud 115200 --wait",
    )
    parser.add_argument(
        "port",
        metavar="PORT",
        help="a serial port, for example /dev/ttyUSB0; tcp:HOST:PORT for RTU frames over TCP;"
        f" modbus-tcp:HOST[:PORT], by default port {_MODBUS_TCP}",
    )
    parser.add_argument("file", metavar="FILE", type=Path, help="the update file, NAME.ex9fw")
    parser.add_argument(
        "modules",
        metavar="MODULE",
        nargs="+",
        type=_module,
        help="an address, 1 to 247, or a serial number with 8 hex digits",
    )
    parser.add_argument("--baud", type=int, choices=_RATES, default=9600, help="the rate of the line; default: 9600")
    parser.add_argument("--format", choices=FORMATS, default="8N1", help="of the line; default: 8N1")
    parser.add_argument(
        "--wait",
        action="store_true",
        help="wait until the modules have confirmed the image: 60 s after its start, if no reset has come in between",
    )
    options = parser.parse_args(arguments)
    if problem := _problem(options):
        parser.error(problem)
    return options


def _module(text: str) -> modbus.Target:
    try:
        return modbus.target(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text}: expected 1 to 247, or 8 hex digits as in 0D001F3A") from None


def _problem(options: argparse.Namespace) -> str:
    """Returns what the parser cannot see."""
    kind = options.port.partition(":")[0]
    place = _TCP.fullmatch(options.port)
    if kind in ("tcp", "modbus-tcp") and (place is None or kind == "tcp" and not place[3]):
        return f"{options.port}: expected tcp:HOST:PORT or modbus-tcp:HOST[:PORT]"
    by_serial_number = [module.name for module in options.modules if not module.has_address]
    if kind == "modbus-tcp" and by_serial_number:
        return (f"{by_serial_number[0]}: Modbus TCP cannot carry a request by serial number; name an address, or use a"
                " serial port or tcp:HOST:PORT")
    twice = [module.name for module in options.modules if options.modules.count(module) > 1]
    return f"{twice[0]}: is there twice; name each module once" if twice else ""


def _open(options: argparse.Namespace) -> modbus.Rtu | modbus.ModbusTcp:
    """Raises PortError."""
    place = _TCP.fullmatch(options.port)
    if place is None:
        return modbus.Rtu(serial_port(options.port, options.baud, options.format), options.baud)
    port = tcp_port(place[2].strip("[]"), int(place[3] or _MODBUS_TCP))
    return modbus.Rtu(port, options.baud) if place[1] == "tcp" else modbus.ModbusTcp(port)


class _Session:
    """Takes several modules through their updates."""

    def __init__(self, updates: list[Update]) -> None:
        self._updates = updates
        self._failed: dict[Update, Failed] = {}

    def run(self, wait: bool) -> int:
        """Returns the exit status. Raises PortError."""
        remark = "nothing has been sent"
        try:
            if self._all(Update.prepare):
                remark = "the modules keep what they have received; the same command continues"
                if self._all(_send):
                    remark = "the modules that have been activated continue without this program"
                    self._start(wait)
                    remark = ""
        except KeyboardInterrupt:
            print(f"send-update: stopped: {remark}", file=sys.stderr)
            return _INTERRUPTED
        except PortError as error:
            raise PortError(f"{error} ({remark})") from error
        result = f"runs {self._updates[0].version}{', confirmed' if wait else ', which it confirms after 60 s'}"
        for update in self._updates:
            text = f"not updated, because another module has failed: {remark}" if remark else result
            text = f"FAILED: {self._failed[update]}" if update in self._failed else text
            print(f"{update.module.target.name}: {text}")
        return 1 if self._failed else 0

    def _start(self, wait: bool) -> None:
        self._all(Update.activate)
        self._all(Update.wait_until_it_runs)
        if wait:
            self._all(Update.wait_until_confirmed)

    def _all(self, step: Callable[[Update], None]) -> bool:
        """Does a step for all modules that have not failed. Returns whether none has."""
        for update in self._updates:
            try:
                if update not in self._failed:
                    step(update)
            except Failed as error:
                self._failed[update] = error
        return not self._failed


def _send(update: Update) -> None:
    with Progress(update.module.target.name) as progress:
        update.send(progress)
