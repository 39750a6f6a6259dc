"""Runs a module on a Pico that the npm package rp2040js emulates, and connects the module to a pseudo-terminal."""
