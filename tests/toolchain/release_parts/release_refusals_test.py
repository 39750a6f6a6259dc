"""Tests what toolchain/release refuses before it builds anything."""

from __future__ import annotations

import pathlib
import shutil
import subprocess
import tempfile
import unittest

from parts import ROOT

FILES = ("firmware/model/model.hpp", "toolchain/release")


class Refusals(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.tree = pathlib.Path(folder.name, "tree")
        for file in FILES:
            (self.tree / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / file, self.tree / file)
        (self.tree / ".github").mkdir()
        shutil.copytree(ROOT / "toolchain/release_parts", self.tree / "toolchain/release_parts")
        self.write("firmware/model/model.hpp", 'constexpr std::string_view kFirmwareVersion = "D01.07";\n')
        self.write(".github/CHANGELOG.md", "# Changelog\n\n## Unreleased\n\n## 1.06 - 2026-01-02\n")
        self.git("init", "--quiet")
        self.git("add", ".")
        self.commit()

    def git(self, *words: str) -> None:
        subprocess.run(["git", "-C", str(self.tree), *words], check=True, capture_output=True)

    def commit(self) -> None:
        self.git("-c", "user.name=t", "-c", "user.email=t@example.org", "commit", "--quiet", "--all", "-m", "tree")

    def write(self, file: str, text: str) -> None:
        (self.tree / file).write_text(text, encoding="utf-8")

    def refused(self, *words: str) -> str:
        done = subprocess.run(
            [str(self.tree / "toolchain/release"), *words], capture_output=True, text=True, check=False
        )
        self.assertNotEqual(done.returncode, 0)
        self.assertFalse((self.tree / "build").exists())
        self.assertEqual(done.stdout, "")
        return done.stderr

    def test_a_version_other_than_that_of_the_tree_is_refused(self) -> None:
        self.assertEqual(
            self.refused("1.08"),
            "toolchain/release: 1.08 is not the version of this tree, 1.07; change kFirmwareVersion in "
            "firmware/model/model.hpp, or release 1.07\n",
        )

    def test_a_tree_with_uncommitted_changes_is_refused(self) -> None:
        self.write("new", "")
        self.assertEqual(
            self.refused("1.07"),
            "toolchain/release: the tree has changes that are not committed; commit or remove what 'git status' "
            "lists\n",
        )

    def test_an_existing_folder_is_refused(self) -> None:
        self.assertEqual(
            self.refused("1.07", str(self.tree)),
            f"toolchain/release: {self.tree} already exists; remove it, or name another folder\n",
        )

    def test_a_version_without_a_section_in_the_changelog_is_refused(self) -> None:
        self.assertEqual(
            self.refused("1.07"),
            ".github/CHANGELOG.md: has no section for this release; add the heading '## 1.07 - YYYY-MM-DD'\n",
        )
        self.write(".github/CHANGELOG.md", "# Changelog\n")
        self.commit()
        self.assertEqual(
            self.refused("--unreleased", "1.07"),
            ".github/CHANGELOG.md: has no section for this release; add the heading '## Unreleased'\n",
        )

    def test_wrong_arguments_are_refused(self) -> None:
        for words in ((), ("--help",), ("1.07", "a", "b")):
            self.assertTrue(self.refused(*words).startswith("Usage: toolchain/release"))


if __name__ == "__main__":
    unittest.main()
