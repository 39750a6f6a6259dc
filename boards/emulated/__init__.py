"""What the programs that run an image in an emulator have in common."""
