"""Runs a module on QEMU's lm3s6965evb and connects the line of the module to a pseudo-terminal."""
