"""Common code of the programs that run an image in an emulator."""
