#!/usr/bin/env python3
"""common/ serves every component and names none, but in the topic table and in comments.

usage: common_names_test.py REPOSITORY
"""
import pathlib
import re
import sys

COMPONENTS = sorted(p.name for p in (pathlib.Path(sys.argv[1]) / "components").iterdir() if p.is_dir())
NAME = re.compile(r"(?<![A-Za-z0-9_])(" + "|".join(COMPONENTS) + r")(?![A-Za-z0-9_])")
# A string keeps its "//"; a comment goes.
STRING_OR_COMMENT = re.compile(r'("(?:\\.|[^"\\\n])*")|//[^\n]*|/\*.*?\*/', re.DOTALL)


def without_comments(text):
    return STRING_OR_COMMENT.sub(lambda m: m.group(1) or "\n" * m.group(0).count("\n"), text)


def names_in(text):
    """(line number, component) for each name outside comments."""
    lines = without_comments(text).split("\n")
    return [(i + 1, m.group(1)) for i, line in enumerate(lines) for m in NAME.finditer(line)]


def main():
    assert names_in('x("/slam/odometry");  // slam\n') == [(1, "slam")]
    assert names_in('// slam\n/* planner\n */ f("http://a", slammed, kPlannerStatus);\n') == []
    common = pathlib.Path(sys.argv[1]) / "common"
    sources = [p for p in sorted(common.rglob("*")) if p.suffix in (".cpp", ".hpp", ".in")]
    assert len(sources) > 50, f"{common} has {len(sources)} sources only"
    failures = 0
    for path in sources:
        inside = str(path.relative_to(common))
        if inside == "topics.hpp" or inside.startswith("topics/"):
            continue
        for line, name in [(0, n) for n in COMPONENTS if path.stem == n] + names_in(path.read_text()):
            print(f"common/{inside}:{line} names {name}: what only a component knows belongs into it, or into its configuration")
            failures += 1
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
