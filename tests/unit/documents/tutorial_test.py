#!/usr/bin/env python3
"""The difference in docs/your_own_method.md applies, compiles, and passes its tests and those of all methods.

usage: tutorial_test.py REPOSITORY BUILD_DIRECTORY CXX_COMPILER
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

REPOSITORY = pathlib.Path(sys.argv.pop(1))
BUILD = pathlib.Path(sys.argv.pop(1))
CXX = sys.argv.pop(1)
FOLDERS = ("components/planner/core/methods", "tests/unit/planner/methods")


def run(*command, cwd):
    result = subprocess.run([str(word) for word in command], cwd=cwd, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        raise AssertionError(" ".join(str(word) for word in command[:3]) + " ...: " + (result.stderr or result.stdout)[-2000:])
    return result.stdout


class Tutorial(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.copy = pathlib.Path(folder.name)
        for name in FOLDERS:
            shutil.copytree(REPOSITORY / name, self.copy / name)

    def apply(self):
        page = (REPOSITORY / "docs/your_own_method.md").read_text(encoding="utf-8")
        blocks = re.findall(r"```diff\n(.*?)```", page, re.DOTALL)
        self.assertEqual(len(blocks), 3)
        patch = self.copy / "random.patch"
        patch.write_text("".join(blocks), encoding="utf-8")
        run("git", "apply", "--unsafe-paths", patch, cwd=self.copy)

    def build(self):
        """Links the copied sources in place of the library of methods, as ninja links the unit test."""
        objects = []
        for source in sorted(path for name in FOLDERS for path in (self.copy / name).glob("*.cpp")):
            objects.append(source.with_suffix(".o"))
            run(CXX, "-std=c++20", "-O0", "-Wall", "-Wextra", "-Werror", "-I", self.copy / "components", "-I",
                REPOSITORY / "components", "-I", REPOSITORY, "-isystem", "/usr/include/eigen3", "-c", source, "-o",
                objects[-1], cwd=self.copy)
        link = run("ninja", "-C", BUILD, "-t", "commands", "planner_methods_test", cwd=self.copy).splitlines()[-1]
        words = link.removeprefix(": && ").removesuffix(" && :").split()
        program = self.copy / "planner_methods_test"
        libraries = [word for word in words[words.index("-o") + 2:] if not word.endswith("libplanner_methods.a")]
        run(CXX, *objects, *libraries, "-o", program, cwd=BUILD)
        return program

    def test_method_of_the_tutorial_passes_its_test_and_those_of_all(self):
        self.apply()
        told = run(self.build(), cwd=self.copy)
        self.assertIn("Random.DrawsFromTheFrontierAndNotFromThePath", told)
        self.assertIn("Methods.AskForAllThatTheirUtilityIsMadeOf", told)


if __name__ == "__main__":
    unittest.main()
