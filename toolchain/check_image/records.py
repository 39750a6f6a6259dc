"""Reads and writes files with the sizes of images. Each image has a line BOARD IMAGE FLASH STATIC STACK. The sizes are
in bytes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

GROWTH = 1.05  # the maximum permitted ratio of the new size to the recorded size, for the flash and for the RAM

Key = tuple[str, str]  # board, image


@dataclass(frozen=True)
class Figures:
    """Sizes in bytes."""

    flash: int
    static: int
    stack: int

    def since(self, before: Figures | None) -> list[str]:
        """Returns flash, static RAM and stack as text. If a size differs from `before`, its text also contains the
        difference, for example `104 (+4)`."""
        if before is None:
            return [str(self.flash), str(self.static), str(self.stack)]
        return [
            f"{now}" if now == then else f"{now} ({now - then:+})"
            for now, then in ((self.flash, before.flash), (self.static, before.static), (self.stack, before.stack))
        ]

    def exceeds(self, before: Figures) -> bool:
        """Returns whether the flash, or the sum of static RAM and stack, is more than 5 % larger than in `before`."""
        return self.flash > GROWTH * before.flash or self.static + self.stack > GROWTH * (
            before.static + before.stack
        )


def read(path: Path | None) -> dict[Key, Figures]:
    """Returns the sizes in a file. Returns no sizes if `path` is None or if the file does not exist."""
    if path is None or not path.exists():
        return {}
    rows = (line.split() for line in path.read_text(encoding="utf-8").splitlines())
    return {(board, image): Figures(*map(int, figures)) for board, image, *figures in rows}


def write(path: Path, rows: Mapping[Key, Figures]) -> None:
    lines = (f"{board} {image} {it.flash} {it.static} {it.stack}\n" for (board, image), it in rows.items())
    path.write_text("".join(lines), encoding="utf-8")
