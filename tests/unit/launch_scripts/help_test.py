#!/usr/bin/env python3
"""Every script says with --help what it does, and does nothing else: in a copy of the repository no file changes.

usage: help_test.py REPOSITORY
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

REPOSITORY = pathlib.Path(sys.argv.pop(1))
SHARED = ("lib.sh", "sources.py", "usage.py", "packages.txt")  # no scripts


def contents(folder):
    return {file: file.read_bytes() for file in folder.rglob("*") if file.is_file()}


class HelpTest(unittest.TestCase):
    def test_help_explains_and_leaves_nothing_behind(self):
        with tempfile.TemporaryDirectory() as folder:
            copy = pathlib.Path(folder)
            for part in ("launch_scripts", ".ci", "docker", "docs", "config", "tests/fuzz"):
                shutil.copytree(REPOSITORY / part, copy / part)
            for kept in ("build/setup.log", "build/release/CMakeCache.txt", "out/explore/manifest.yaml"):
                (copy / kept).parent.mkdir(parents=True, exist_ok=True)
                (copy / kept).write_text("of before\n")
            before = contents(copy)
            scripts = [file for file in sorted((copy / "launch_scripts").iterdir())
                       if file.is_file() and file.name not in SHARED]
            self.assertGreater(len(scripts), 8)
            others = (".ci/run", ".ci/tidy", "docker/check.sh", "tests/fuzz/run.sh")
            for script in [*scripts, *(copy / other for other in others)]:
                with self.subTest(script.name):
                    result = subprocess.run([script, "--help"], cwd=copy, capture_output=True, text=True, check=False,
                                            env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}, stdin=subprocess.DEVNULL)
                    self.assertEqual(result.returncode, 0, result.stderr)
                    self.assertIn("usage", (result.stdout + result.stderr).lower())
                    self.assertEqual(contents(copy), before)


if __name__ == "__main__":
    unittest.main(verbosity=2)
