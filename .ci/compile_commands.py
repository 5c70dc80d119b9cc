#!/usr/bin/env python3
"""The compile commands of every source of its own, for clang-tidy, where the build compiles many in one unit.

usage: compile_commands.py BUILD_FOLDER OUTPUT_FOLDER
"""
import json
import os
import re
import sys


GCC_ONLY = " -Wno-subobject-linkage"  # an unknown option is an error of clang-tidy's; only units need it


def sources_of(unit):
    """What a unit that CMake wrote includes; a source that is compiled alone is its own."""
    if "/Unity/" not in unit:
        return [unit]
    with open(unit) as file:
        return re.findall(r'^#include "([^"]+)"', file.read(), re.MULTILINE)


def main():
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    build, output = sys.argv[1:]
    with open(os.path.join(build, "compile_commands.json")) as file:
        units = json.load(file)
    commands = [
        {"directory": unit["directory"], "command": unit["command"].replace(unit["file"], source).replace(GCC_ONLY, ""),
         "file": source}
        for unit in units
        for source in sources_of(unit["file"])
    ]
    os.makedirs(output, exist_ok=True)
    with open(os.path.join(output, "compile_commands.json"), "w") as file:
        json.dump(commands, file, indent=1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
