"""Tests the bill of materials: its form, and whether it names the libraries whose headers the simulator includes."""

from __future__ import annotations

import json
import re
import subprocess
import unittest

from parts import ROOT, SECONDS
from bill_of_materials import COMPONENTS, bill_of_materials

VERSIONS = {component.package: "1.0+x-1" for component in COMPONENTS}
# The first folder of an included path, and the component to which this folder belongs.
FOLDERS = {"boost": "Boost", "CLI": "CLI11", "nlohmann": "nlohmann-json", "yaml-cpp": "yaml-cpp"}
SYSTEM = {"sys", "netinet", "asm", "linux", "arpa"}  # folders of the C library and of the kernel


class BillOfMaterials(unittest.TestCase):
    def setUp(self) -> None:
        self.document = json.loads(bill_of_materials("1.00", "abc", SECONDS, VERSIONS))

    def test_the_document_and_its_packages_have_the_main_fields_of_spdx_2_3(self) -> None:
        self.assertEqual(self.document["spdxVersion"], "SPDX-2.3")
        self.assertEqual(self.document["dataLicense"], "CC0-1.0")
        self.assertEqual(self.document["SPDXID"], "SPDXRef-DOCUMENT")
        self.assertEqual(self.document["creationInfo"]["created"], "2026-09-21T14:13:20Z")
        self.assertIn("abc", self.document["documentNamespace"])
        for package in self.document["packages"]:
            self.assertRegex(package["SPDXID"], r"^SPDXRef-[A-Za-z0-9.-]+$")
            self.assertTrue({"name", "downloadLocation", "licenseConcluded", "copyrightText"} <= set(package))

    def test_the_relationships_name_the_document_and_all_packages_and_nothing_else(self) -> None:
        known = {package["SPDXID"] for package in self.document["packages"]} | {"SPDXRef-DOCUMENT"}
        self.assertEqual(len(known), len(self.document["packages"]) + 1)
        ends = {end for r in self.document["relationships"] for end in (r["spdxElementId"], r["relatedSpdxElement"])}
        self.assertEqual(ends, known)

    def test_it_names_each_library_that_the_simulator_includes_except_the_system_libraries(self) -> None:
        included = set()
        for path in self.includes("sim"):
            folder = path.partition("/")[0]
            if "/" in path and folder not in SYSTEM:
                included.add(FOLDERS[folder])
        self.assertEqual(included, set(FOLDERS.values()))
        self.assertTrue(included <= {component.key for component in COMPONENTS})

    def test_firmware_hal_and_boards_include_no_library_header_with_a_folder_or_an_extension(self) -> None:
        for path in self.includes("firmware", "hal", "boards"):
            self.assertRegex(path, r"^[a-z_]+$")

    def includes(self, *folders: str) -> set[str]:
        """Returns the headers that the sources in `folders` include in angle brackets."""
        listed = subprocess.run(
            ["git", "grep", "-hoE", "^#include <[^>]+>", "--", *folders],
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=True,
        )
        return set(re.findall(r"<(.+)>", listed.stdout))


if __name__ == "__main__":
    unittest.main()
