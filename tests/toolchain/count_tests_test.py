"""Tests count-tests. tests/run counts the tests in CTest's log with count-tests."""

import pathlib
import subprocess
import tempfile
import unittest

COUNT_TESTS = pathlib.Path(__file__).resolve().parents[1] / "count-tests"


def count(log, table):
    """Runs count-tests on two files with the contents `log` and `table`. Returns the numbers of passed, failed and
    skipped tests that count-tests prints."""
    with tempfile.TemporaryDirectory() as folder:
        files = [pathlib.Path(folder, name) for name in ("log", "table")]
        for file, text in zip(files, (log, table)):
            file.write_text(text, encoding="utf-8")
        printed = subprocess.run([COUNT_TESTS, *files], check=True, capture_output=True, encoding="utf-8").stdout
    return tuple(int(number) for number in printed.split())


class CountTests(unittest.TestCase):
    def test_each_test_of_a_googletest_program_is_counted(self):
        log = (
            "1/1 Testing: bus_test\n"
            "[  FAILED  ] Bus.Arrives (3 ms)\n"
            "[  FAILED  ] Ways/Bus.Arrives/1, where GetParam() = 5 (3 ms)\n"
            "[  PASSED  ] 5 tests.\n"
            "[  SKIPPED ] 1 test.\n"
        )
        self.assertEqual(count(log, "bus_test 1 FAILED ctest\n"), (5, 2, 1))

    def test_each_test_of_a_unittest_program_is_counted(self):
        log = (
            "1/1 Testing: bus_py\n"
            "ERROR: test_a (bus_test.Bus.test_a)\n"
            "FAIL: test_b (bus_test.Bus.test_b)\n"
            "FAIL: test_b (bus_test.Ring.test_b)\n"
            "Ran 9 tests in 1 s\n"
            "FAILED (failures=2, errors=1, skipped=1)\n"
        )
        self.assertEqual(count(log, "bus_py 1 FAILED ctest\n"), (5, 3, 1))
        log = "1/1 Testing: bus_py\nRan 9 tests in 1 s\nOK (skipped=2)\n"
        self.assertEqual(count(log, "bus_py 1 passed ctest\n"), (7, 0, 2))

    def test_a_unittest_with_several_failed_subtests_counts_as_one_failed_test(self):
        log = (
            "1/1 Testing: bus_py\n"
            "FAIL: test_a (bus_test.Bus.test_a) (rate=1200)\n"
            "FAIL: test_a (bus_test.Bus.test_a) (rate=9600)\n"
            "ERROR: setUpClass (bus_test.Ring)\n"
            "Ran 2 tests in 1 s\n"
            "FAILED (failures=2, errors=1)\n"
        )
        self.assertEqual(count(log, "bus_py 1 FAILED ctest\n"), (1, 2, 0))

    def test_a_part_that_fails_without_a_failed_test_counts_as_one_failed_test(self):
        log = "1/2 Testing: bus_test\nterminate called\n2/2 Testing: line_test\n[  PASSED  ] 5 tests.\n"
        self.assertEqual(count(log, "build 1 FAILED b\nbus_test 1 FAILED b\nline_test 1 passed b\n"), (5, 2, 0))


if __name__ == "__main__":
    unittest.main()
