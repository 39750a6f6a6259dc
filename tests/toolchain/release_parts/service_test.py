"""Tests when systemd starts the packaged service, and when it starts the service again."""

import pathlib
import unittest

UNIT = pathlib.Path(__file__).resolve().parents[3] / "toolchain/release_parts/debian/ex9000-sim@.service"


class Service(unittest.TestCase):
    def setUp(self) -> None:
        lines = UNIT.read_text(encoding="utf-8").splitlines()
        self.settings = dict(line.split("=", 1) for line in lines if "=" in line and not line.startswith("#"))

    def test_the_service_waits_until_the_addresses_of_this_machine_exist(self) -> None:
        self.assertEqual(self.settings["After"], "network-online.target")
        self.assertEqual(self.settings["Wants"], "network-online.target")

    def test_the_service_is_started_again_without_limit_but_not_if_its_configuration_is_wrong(self) -> None:
        self.assertEqual(self.settings["Restart"], "on-failure")
        self.assertEqual(self.settings["RestartSec"], "5")
        self.assertEqual(self.settings["StartLimitIntervalSec"], "0")
        # sim/docs/command-line.md, Exit status
        self.assertEqual(self.settings["RestartPreventExitStatus"], "2")


if __name__ == "__main__":
    unittest.main()
