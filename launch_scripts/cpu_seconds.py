#!/usr/bin/env python3
"""CPU seconds of the steps of a build, for build_report.sh.

usage: cpu_seconds.py run FILE COMMAND...        runs COMMAND and adds a line to FILE: CPU seconds, what it made
       cpu_seconds.py table FILE FOLDER WHOLE    prints what is in FILE, of the build in FOLDER; WHOLE: FILE of all of it
"""
import collections
import os
import re
import resource
import subprocess
import sys

DEAREST = 20


def run(path, command):
    status = subprocess.run(command).returncode
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    made = command[command.index("-o") + 1] if "-o" in command else command[0]
    line = f"{used.ru_utime + used.ru_stime:.2f}\t{os.path.abspath(made)}\n"
    file = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)
    os.write(file, line.encode())  # one write: steps that run side by side do not mix
    return status


def rows(path):
    with open(path) as file:
        return [(float(seconds), made) for seconds, made in (line.rstrip("\n").split("\t") for line in file)]


def folder_of(made):
    """components/slam/core/CMakeFiles/... -> components/slam; bin/... -> linking."""
    if not made.endswith(".o"):
        return "linking"
    parts = made.split("/CMakeFiles/")[0].split("/")
    return "/".join(parts[:2]) if parts[0] in ("common", "components", "tests") else parts[0]


def table(path, folder, whole):
    steps = [(seconds, os.path.relpath(made, folder)) for seconds, made in rows(path)]
    by_folder, count = collections.Counter(), collections.Counter()
    for seconds, made in steps:
        by_folder[folder_of(made)] += seconds
        count[folder_of(made)] += 1
    measured, total = sum(by_folder.values()), sum(seconds for seconds, _ in rows(whole))
    print("| folder | steps | CPU s | share % |\n| --- | --- | --- | --- |")
    for name, seconds in by_folder.most_common():
        print(f"| {name} | {count[name]} | {seconds:.1f} | {100 * seconds / total:.1f} |")
    print(f"| code generation, archives, ninja | | {total - measured:.1f} | {100 * (total - measured) / total:.1f} |")
    print(f"| all | {len(steps)} | {total:.1f} | 100 |")
    print(f"\nThe {DEAREST} dearest files:\n\n| file | CPU s |\n| --- | --- |")
    for seconds, made in sorted(steps, reverse=True)[:DEAREST]:
        source = re.sub(r"CMakeFiles/([^/]*)[.]dir/", r"[\1] ", made)
        print(f"| {source} | {seconds:.1f} |")


def main():
    if len(sys.argv) >= 4 and sys.argv[1] == "run":
        return run(sys.argv[2], sys.argv[3:])
    if len(sys.argv) == 5 and sys.argv[1] == "table":
        table(*sys.argv[2:])
        return 0
    asks = sys.argv[1:] in (["--help"], ["-h"])
    print(__doc__.strip(), file=sys.stdout if asks else sys.stderr)
    return 0 if asks else 2


if __name__ == "__main__":
    sys.exit(main())
