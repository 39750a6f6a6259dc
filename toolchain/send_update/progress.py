"""Shows how much of an image a module has: a bar in a terminal, else a line for each tenth."""

from __future__ import annotations

import sys

_WIDTH = 40


class Progress:
    def __init__(self, name: str, stream=None) -> None:
        self._name = name
        self._stream = stream or sys.stderr
        self._tenth = -1

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, *_) -> None:
        if self._stream.isatty():
            print(file=self._stream)

    def __call__(self, has: int, length: int) -> None:
        percent = 100 * has // length
        if self._stream.isatty():
            marks = "#" * (_WIDTH * has // length)
            print(f"\r{self._name} [{marks:{_WIDTH}}] {percent:3} %", end="", file=self._stream, flush=True)
        elif percent // 10 != self._tenth:
            self._tenth = percent // 10
            print(f"{self._name}: {percent} % of {length} bytes", file=self._stream, flush=True)
