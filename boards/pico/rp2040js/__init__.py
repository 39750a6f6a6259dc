"""Runs a module on a Pico in npm's rp2040js and connects it to a pseudo-terminal."""
