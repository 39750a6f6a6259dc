"""Runs a module on QEMU's lm3s6965evb and connects it to a pseudo-terminal."""
