"""Tests that each relative link in a document leads to an existing file and heading, that links lead from README.md to
each document, and that README.md has at most 250 lines."""

from __future__ import annotations

import re
import subprocess
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LINK = re.compile(r"\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+ +(.*)$")


def documents() -> list[Path]:
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard", "*.md"],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    )
    return [ROOT / name for name in listed.stdout.split() if (ROOT / name).exists()]


def prose_of(document: Path) -> list[str]:
    """Returns the lines outside of code blocks."""
    lines = []
    inside = False
    for line in document.read_text(encoding="utf-8").splitlines():
        if line.startswith("```"):
            inside = not inside
        elif not inside:
            lines.append(line)
    return lines


def anchors_of(document: Path) -> set[str]:
    """Returns the anchors of all headings, in the form that GitHub uses."""
    anchors: set[str] = set()
    for line in prose_of(document):
        if match := HEADING.match(line):
            text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", match[1]).replace("\\", "")
            anchor = re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-")
            repeated = next(n for n in range(99) if (f"{anchor}-{n}" if n else anchor) not in anchors)
            anchors.add(f"{anchor}-{repeated}" if repeated else anchor)
    return anchors


class Links(unittest.TestCase):
    def test_each_link_has_a_target(self) -> None:
        checked = 0
        for document in documents():
            for link in LINK.findall("\n".join(prose_of(document))):
                if re.match(r"[a-z]+:", link):
                    continue  # not a relative link
                name, _, anchor = link.partition("#")
                target = (document.parent / name).resolve() if name else document
                with self.subTest(document=str(document.relative_to(ROOT)), link=link):
                    self.assertTrue(target.exists(), "no such file")
                    if anchor and target.suffix == ".md":
                        self.assertIn(anchor, anchors_of(target))
                checked += 1
        self.assertGreater(checked, 150)


class Documents(unittest.TestCase):
    def test_the_readme_has_at_most_250_lines(self) -> None:
        self.assertLessEqual(len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()), 250)

    def test_links_lead_from_the_readme_to_each_document(self) -> None:
        reached = {ROOT / "README.md"}
        waiting = [ROOT / "README.md"]
        while waiting:
            document = waiting.pop()
            for link in LINK.findall("\n".join(prose_of(document))):
                target = (document.parent / link.partition("#")[0]).resolve()
                if target.suffix == ".md" and target.exists() and target not in reached:
                    reached.add(target)
                    waiting.append(target)
        self.assertEqual({str(each.relative_to(ROOT)) for each in set(documents()) - reached}, set())


if __name__ == "__main__":
    unittest.main()
