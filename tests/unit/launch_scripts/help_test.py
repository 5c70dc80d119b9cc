#!/usr/bin/env python3
"""Every script says with --help what it does, and does nothing else.

usage: help_test.py REPOSITORY
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

REPOSITORY = pathlib.Path(sys.argv.pop(1))
SHARED = ("lib.sh", "usage.py", "packages.txt")  # no scripts


class HelpTest(unittest.TestCase):
    def test_help_explains_and_leaves_nothing_behind(self):
        scripts = [file for file in sorted((REPOSITORY / "launch_scripts").iterdir())
                   if file.is_file() and file.name not in SHARED]
        self.assertGreater(len(scripts), 8)
        for script in [*scripts, REPOSITORY / ".ci/run", REPOSITORY / "tests/fuzz/run.sh"]:
            with self.subTest(script.name), tempfile.TemporaryDirectory() as folder:
                result = subprocess.run([script, "--help"], cwd=folder, capture_output=True, text=True, check=False,
                                        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}, stdin=subprocess.DEVNULL)
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertIn("usage", (result.stdout + result.stderr).lower())
                self.assertEqual(list(pathlib.Path(folder).iterdir()), [])


if __name__ == "__main__":
    unittest.main(verbosity=2)
