#!/usr/bin/python3
"""Runs ex9000 on a rig whose modules, like the module to verify, are simulated. The wires between them are here: before
the request they carry the outputs of the module to the inputs of the rig, and after it those of the rig to the module.
"""

import os
import socket
import subprocess
import sys

SUPPLY, INIT, INPUTS = 1 << 8, 1 << 9, 8  # the outputs of the rig: two bits, and the first channels
SEEN = 16


class Simulator:
    def __init__(self, control):
        self._socket = socket.socket(socket.AF_UNIX)
        self._socket.connect(control)
        self._answers = self._socket.makefile(encoding="utf-8")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._answers.close()
        self._socket.close()

    def tell(self, command):
        """Returns the text after `ok`. Raises ValueError if the answer is another one."""
        self._socket.sendall(f"{command}\n".encode())
        word, _, text = self._answers.readline().rstrip("\n").partition(" ")
        if word != "ok":
            raise ValueError(f"'{command}': {word} {text}")
        return text

    def levels(self, command):
        return int(self.tell(command), 16)

    def set_inputs(self, module, wanted, channels):
        changed = self.levels(f"{module} inputs") ^ wanted
        for channel in range(channels):
            if changed >> channel & 1:
                self.tell(f"{module} input {channel} {'on' if wanted >> channel & 1 else 'off'}")


def main():
    with Simulator("rig.ctl") as rig, Simulator("module.ctl") as module:
        rig.set_inputs(2, module.levels("1 outputs"), SEEN)
        status = subprocess.call([os.environ["EX9000_UTILITY"], *sys.argv[1:]])
        on = rig.levels("1 outputs")
        module.tell(f"1 init {'on' if on & INIT else 'off'}")
        if ("power=on" in module.tell("1 status").split()) != bool(on & SUPPLY):
            module.tell(f"1 power {'on' if on & SUPPLY else 'off'}")
        module.set_inputs(1, on, INPUTS)
    return status


if __name__ == "__main__":
    sys.exit(main())
