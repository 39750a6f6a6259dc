"""Helpers for the tests of the release parts."""

from __future__ import annotations

import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[3]
PROGRAM = ROOT / "build/host-debug/sim/ex9000-sim"
UTILITY = ROOT / "build/host-debug/sim/ex9000"
WRITE = ROOT / "toolchain/release_parts/write"
SECONDS = 1_790_000_000  # the date of the release for the tests: 2026-09-21 14:13:20 UTC

sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "toolchain/release_parts"))


def written(*words: str) -> str:
    """Runs toolchain/release_parts/write with the arguments `words`. Returns its standard output. Raises AssertionError
    if its exit status is not 0."""
    environment = {"PATH": "/usr/bin:/bin", "SOURCE_DATE_EPOCH": str(SECONDS)}
    done = subprocess.run([str(WRITE), *words], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def printed(*words: str) -> str:
    """Runs ex9000-sim with the arguments `words`. Returns its standard output. Raises CalledProcessError if the program
    fails."""
    return subprocess.run([str(PROGRAM), *words], capture_output=True, text=True, check=True).stdout
