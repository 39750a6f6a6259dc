"""Runs a module on a Pico in the npm package rp2040js and connects the module to a pseudo-terminal."""
