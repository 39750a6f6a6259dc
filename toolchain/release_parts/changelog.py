"""Finds a section of .github/CHANGELOG.md, and converts it to release notes and to a Debian changelog."""

from __future__ import annotations

import datetime
import re
import textwrap
from dataclasses import dataclass

_RELEASE = re.compile(r"^## (\d+\.\d+) - (\d{4}-\d\d-\d\d)$")
_UNRELEASED = "## Unreleased"


class NoSection(Exception):
    """The changelog does not have the requested section."""


@dataclass
class Section:
    version: str
    date: datetime.date | None  # None if the version is not released
    lines: list[str]  # without the heading


def section_of(version: str, changelog: str, unreleased: bool) -> Section:
    """Returns the section of a version. If `unreleased` is true, returns the section "Unreleased" instead.

    Raises NoSection if the changelog does not have this section.
    """
    lines = changelog.splitlines()
    for number, line in enumerate(lines):
        release = _RELEASE.match(line)
        if (unreleased and line == _UNRELEASED) or (not unreleased and release and release[1] == version):
            following = (at for at in range(number + 1, len(lines)) if lines[at].startswith("## "))
            content = lines[number + 1 : next(following, len(lines))]
            date = datetime.date.fromisoformat(release[2]) if release else None
            return Section(version, date, "\n".join(content).strip("\n").splitlines())
    expected = _UNRELEASED if unreleased else f"## {version} - YYYY-MM-DD"
    raise NoSection(f"has no section for this release; add the heading '{expected}'")


def release_notes(section: Section, commit: str) -> str:
    """Returns the section as a separate document. Links to files of the repository become plain text."""
    title = f"# OpenEX9000 {section.version}" + ("" if section.date else ", not released")
    text = re.sub(r"\[([^\]]+)\]\((?![a-z]+:)[^)]*\)", r"\1", "\n".join(section.lines))
    text = re.sub(r"^###", "##", text, flags=re.MULTILINE)
    return f"{title}\n\nCommit {commit}.\n\n{text}\n"


def debian_changelog(section: Section, maintainer: str, released: datetime.datetime) -> str:
    """Returns the changelog of a Debian package: one entry with the items of the section."""
    text = re.sub(r"\[([^\]]+)\]\([^)]*\)", r"\1", "\n".join(section.lines))
    items = re.findall(r"^- (.*(?:\n  .*)*)", text, flags=re.MULTILINE)
    indents = {"initial_indent": "  * ", "subsequent_indent": "    "}
    body = [textwrap.fill(" ".join(item.split()), 78, **indents) for item in items]
    stamp = released.strftime("%a, %d %b %Y %H:%M:%S +0000")
    entry = [f"ex9000-sim ({section.version}) stable; urgency=medium", "", *body, "", f" -- {maintainer}  {stamp}"]
    return "\n".join(entry) + "\n"
