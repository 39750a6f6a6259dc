"""QEMU's lm3s6965evb as a module on a pseudo-terminal."""
