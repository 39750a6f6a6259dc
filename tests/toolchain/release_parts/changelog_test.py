"""Tests the functions that read and convert the changelog, and checks the real changelog."""

from __future__ import annotations

import datetime
import unittest

from parts import ROOT, written
from changelog import NoSection, debian_changelog, release_notes, section_of

TEXT = """# Changelog

## Unreleased

### Added

- Something [new](../new.md).

## 1.01 - 2026-12-24

### Fixed

- A [fault](../firmware/wire.md#1-models) that is
  [known](https://example.org).
- Another.

## 1.00 - 2026-11-30

- The first.
"""


class Changelog(unittest.TestCase):
    def test_the_section_of_a_version_ends_at_the_next_section(self) -> None:
        section = section_of("1.01", TEXT, False)
        self.assertEqual(section.date, datetime.date(2026, 12, 24))
        self.assertEqual((section.lines[0], section.lines[-1]), ("### Fixed", "- Another."))
        self.assertEqual(section_of("1.00", TEXT, False).lines, ["- The first."])

    def test_a_missing_section_is_reported(self) -> None:
        with self.assertRaisesRegex(NoSection, "add the heading '## 1.02 - YYYY-MM-DD'"):
            section_of("1.02", TEXT, False)
        with self.assertRaisesRegex(NoSection, "add the heading '## Unreleased'"):
            section_of("1.00", "## 1.00 - 2026-11-30\n", True)

    def test_release_notes_have_no_links_to_files(self) -> None:
        notes = release_notes(section_of("1.01", TEXT, False), "abc")
        self.assertEqual(
            notes,
            "# OpenEX9000 1.01\n\nCommit abc.\n\n## Fixed\n\n"
            "- A fault that is\n  [known](https://example.org).\n- Another.\n",
        )
        self.assertIn("# OpenEX9000 1.02, not released\n", release_notes(section_of("1.02", TEXT, True), "abc"))

    def test_a_debian_changelog_has_one_entry(self) -> None:
        released = datetime.datetime(2026, 12, 24, 8, 0, tzinfo=datetime.timezone.utc)
        self.assertEqual(
            debian_changelog(section_of("1.01", TEXT, False), "A <a@example.org>", released),
            "ex9000-sim (1.01) stable; urgency=medium\n\n  * A fault that is known.\n  * Another.\n\n"
            " -- A <a@example.org>  Thu, 24 Dec 2026 08:00:00 +0000\n",
        )

    def test_the_real_changelog_has_an_unreleased_section_with_items_or_a_released_section(self) -> None:
        text = (ROOT / ".github/CHANGELOG.md").read_text("utf-8")
        if "## Unreleased\n" in text:
            self.assertIn("- ", written("release-notes", "1.00", "abc", "--unreleased"))
        else:
            self.assertRegex(text, r"\n## \d+\.\d+ - \d{4}-\d\d-\d\d\n")


if __name__ == "__main__":
    unittest.main()
