"""The recorded sizes of images: one line of BOARD IMAGE FLASH STATIC STACK for each image, in bytes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

GROWTH = 1.05  # permitted growth without a new record

Key = tuple[str, str]  # board, image


@dataclass(frozen=True)
class Figures:
    """Sizes in bytes."""

    flash: int
    static: int
    stack: int

    def since(self, before: Figures | None) -> list[str]:
        """Returns flash, static RAM and stack as text, with the changes since `before`."""
        if before is None:
            return [str(self.flash), str(self.static), str(self.stack)]
        return [
            f"{now}" if now == then else f"{now} ({now - then:+})"
            for now, then in ((self.flash, before.flash), (self.static, before.static), (self.stack, before.stack))
        ]

    def exceeds(self, before: Figures) -> bool:
        """Returns whether flash, or RAM as a whole, has grown by more than 5 %."""
        return self.flash > GROWTH * before.flash or self.static + self.stack > GROWTH * (
            before.static + before.stack
        )


def read(path: Path | None) -> dict[Key, Figures]:
    if path is None or not path.exists():
        return {}
    rows = (line.split() for line in path.read_text(encoding="utf-8").splitlines())
    return {(board, image): Figures(*map(int, figures)) for board, image, *figures in rows}


def write(path: Path, rows: Mapping[Key, Figures]) -> None:
    lines = (f"{board} {image} {it.flash} {it.static} {it.stack}\n" for (board, image), it in rows.items())
    path.write_text("".join(lines), encoding="utf-8")
