#!/usr/bin/env python3
"""Pages can be read in a terminal, and their links lead somewhere.

usage: pages_test.py REPOSITORY
"""
import pathlib
import re
import sys
import unittest

REPOSITORY = pathlib.Path(sys.argv.pop(1))
LONGEST_LINE = 160
GENERATED = ("docs/results/", "docs/media/")  # reports, and what lapis_simulator --credits prints
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")


def pages():
    """Those that people write; a copy of the sources need not be a git repository."""
    found = [page.relative_to(REPOSITORY) for page in sorted(REPOSITORY.rglob("*.md"))]
    return [REPOSITORY / page for page in found
            if not str(page).startswith(GENERATED) and not {"build", "out", "node_modules"} & set(page.parts)]


def lines_of_text(text):
    """(number, line) outside of code blocks and tables."""
    is_code = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            is_code = not is_code
        elif not is_code and not line.startswith("    ") and not line.lstrip().startswith("|"):
            yield number, line


def without_code(line):
    return re.sub(r"`[^`]*`", "", line)


def anchors(page):
    """As GitHub makes them of headings."""
    headings = [line.lstrip("#").strip() for _, line in lines_of_text(page.read_text()) if line.startswith("#")]
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def broken_links(page):
    for number, line in lines_of_text(page.read_text()):
        for target in LINK.findall(without_code(line)):
            if re.match(r"[a-z]+:", target):
                continue
            file, _, anchor = target.partition("#")
            there = (page.parent / file).resolve() if file else page
            if not there.exists() or anchor and there.suffix == ".md" and anchor not in anchors(there):
                yield f"{page.relative_to(REPOSITORY)}:{number}: {target} leads nowhere"


class Pages(unittest.TestCase):
    def test_there_are_pages(self):
        self.assertGreater(len(pages()), 50)

    def test_lines_of_text_are_short_enough_to_read(self):
        long = [f"{page.relative_to(REPOSITORY)}:{number}: {len(line)} characters" for page in pages()
                for number, line in lines_of_text(page.read_text()) if len(line) > LONGEST_LINE]
        self.assertEqual(long, [], f"longer than {LONGEST_LINE}")

    def test_links_lead_somewhere(self):
        self.assertEqual([problem for page in pages() for problem in broken_links(page)], [])

    def test_decisions_that_are_named_exist(self):
        there = {page.name[:4] for page in (REPOSITORY / "docs/decisions").glob("*.md")}
        named = [(page.relative_to(REPOSITORY), found) for page in pages()
                 for found in re.findall(r"docs/decisions/(\d{4})", page.read_text())]
        self.assertGreater(len(named), 10)
        self.assertEqual([entry for entry in named if entry[1] not in there], [])


if __name__ == "__main__":
    unittest.main()
