"""Tests the selection and the order of the tests that check a changed file."""

import re
import unittest

import programs

# Files that no unit of their area contains, because headers of the tests replace them.
REACHED_BY_NONE = {"hal/registers/bus.hpp", "hal/cortex_m/processor.hpp"}


class Programs(unittest.TestCase):
    def setUp(self):
        self.areas = {area.name: area for area in programs.areas()}

    def nearest(self, area, file):
        return [program.name for program in self.areas[area].nearest_first(file)]

    def test_every_file_is_compiled_into_a_test_except_the_files_in_reached_by_none(self):
        for area in self.areas.values():
            unreached = {file for file in area.sources if not area.nearest_first(file)}
            self.assertEqual(unreached - REACHED_BY_NONE, set(), area.name)

    def test_tests_with_the_name_of_the_file_come_first(self):
        self.assertEqual(self.nearest("firmware", "firmware/line/crc16.hpp")[0], "crc16_test")
        self.assertEqual(self.nearest("hal", "hal/pl011/uart.hpp")[0], "uart_driver_test")
        self.assertEqual(self.nearest("hal", "hal/flash/record_log.hpp")[0], "record_log_test")
        self.assertEqual(self.nearest("sim", "sim/virtual_line/wires/wires.cpp")[0], "bus_test")

    def test_if_no_test_has_the_name_of_the_file_tests_that_include_the_header_come_first(self):
        self.assertEqual(self.nearest("hal", "hal/stellaris/outputs.hpp")[0], "pins_driver_test")
        self.assertEqual(self.nearest("hal", "hal/at24c/at24c.hpp")[0], "eeprom_driver_test")
        self.assertEqual(self.nearest("hal", "hal/rp2040/flash.hpp")[0], "rp2040_drivers_test")

    def test_a_file_that_no_driver_test_compiles_is_tested_in_whole_images(self):
        images = ["start_up_driver_test", "image_driver_test"]
        self.assertEqual(self.nearest("hal", "hal/cortex_m/interrupts.hpp"), images)

    def test_every_driver_of_the_area_hal_except_doubles_and_reached_by_none_is_part_of_the_product(self):
        product = {file for unit in self.areas["hal"].product for file in unit.files}
        shipped = {file for file in self.areas["hal"].sources if not file.startswith("hal/doubles/")}
        self.assertEqual(shipped - product - REACHED_BY_NONE, set())

    def test_every_header_of_the_area_sim_is_part_of_the_product(self):
        product = {file for unit in self.areas["sim"].product for file in unit.files}
        headers = {file for file in self.areas["sim"].sources if file.endswith(".hpp")}
        self.assertEqual(headers - product, set())

    def test_a_run_uses_every_test_named_in_the_cmakelists_of_tests_hal(self):
        text = (programs.ROOT / "tests/hal/CMakeLists.txt").read_text(encoding="utf-8")
        names = set(re.findall(r"ex9000_test\((\w+)", text))
        self.assertIn("memory_test", names)
        self.assertEqual(names - {program.name for program in programs.listed_programs("tests/hal")}, set())

    def test_a_run_uses_every_test_named_in_the_cmakelists_of_tests_sim_except_some(self):
        text = (programs.ROOT / "tests/sim/CMakeLists.txt").read_text(encoding="utf-8")
        names = set(re.findall(r"ex9000_test\((\w+)", text))
        used = {program.name for program in programs.listed_programs("tests/sim")}
        unused = {"command_cost_test", "map_test", "pacer_test", "ports_parts_test", "tcp_port_test"}
        self.assertEqual(names - used, unused)

    def test_a_unit_with_a_shadow_folder_contains_the_shadow_and_not_the_shadowed_header(self):
        unit = programs.LIBRARY_UNITS["mcu_model"]
        self.assertIn("tests/mcu_model/shadow/hal/registers/bus.hpp", unit.files)
        self.assertNotIn("hal/registers/bus.hpp", unit.files)


if __name__ == "__main__":
    unittest.main()
