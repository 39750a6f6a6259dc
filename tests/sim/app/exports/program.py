"""Runs `ex9000-sim describe` and `ex9000-sim --models`."""

import os
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[4]
PROGRAM = os.environ.get("EX9000_SIMULATOR", str(ROOT / "build/host-debug/sim/ex9000-sim"))


def run(*arguments):
    return subprocess.run([PROGRAM, *arguments], check=True, capture_output=True, encoding="utf-8").stdout


def describe(*arguments):
    return run("describe", *arguments)


def models_with_modbus():
    """Returns the models with Modbus. Raises LookupError if one of five known models is missing."""
    models = [line.split()[0] for line in run("--models").splitlines() if "Modbus RTU" in line]
    missing = {"EX9042D-M", "EX9043D-M", "EX9052D-M", "EX9068D-M", "EX9068AD-M"} - set(models)
    if missing:
        raise LookupError(f"--models: no 'Modbus RTU' in the line of {', '.join(sorted(missing))}; expected it in each")
    return models
