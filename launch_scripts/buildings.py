#!/usr/bin/python3
"""Checks generated buildings with the scene validator, one process at a time, and prints a table (docs/buildings.md).

usage: buildings.py CSV_FILE [--kinds KIND,...] [--first SEED] [--count N]

Status 1 when a building fails. CSV_FILE gets a row for every building, and is where a later call goes on: buildings that
are drawn as they were are not checked again. Seeds are those for tuning, below 10,000; the others are not to be looked at.
The programs are those of build/release, or of the folder in LAPIS_BIN.
"""

import argparse
import csv
import hashlib
import os
import pathlib
import re
import resource
import statistics
import subprocess
import sys
import tempfile

import yaml

KINDS = ("flat", "office", "ring", "warehouse", "clinic")
LAST_TUNING_SEED = 9999
COLUMNS = ("kind", "seed", "drawn", "area_m2", "rooms", "failed", "poor_views_percent", "cpu_s")
BIN = pathlib.Path(os.environ.get("LAPIS_BIN", pathlib.Path(__file__).resolve().parent.parent / "build/release/bin"))
SIMULATOR = BIN / "lapis_simulator"


def draw(kind, seed):
    """The scene file of a building."""
    command = [SIMULATOR, "--generate", str(seed), "--kind", kind]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def area_m2(polygon):
    pairs = zip(polygon, polygon[1:] + polygon[:1])
    return abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in pairs)) / 2


def validate(name):
    """Exit status, table, and CPU time [s] of the validator. It keeps no baked light."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    with tempfile.TemporaryDirectory() as folder:
        command = [SIMULATOR, name, "--validate", "--set", f"simulator.output_dir={folder}",
                   "--set", f"simulator.world.light_folder={folder}"]
        result = subprocess.run(command, check=False, capture_output=True, text=True)
    used_s = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    return result.returncode, result.stdout, result.stderr, used_s


def check_building(kind, seed, scene, drawn):
    status, table, errors, used_s = validate(f"{kind}_{seed}")
    failed = re.findall(r"^FAIL +(\w+)", table, re.MULTILINE)
    if status != 0 and not failed:
        failed = ["status " + str(status) + ": " + " ".join(errors.split()[-20:])]
    poor = re.search(r"^\w+ +features +([0-9.]+) %", table, re.MULTILINE)
    rooms = yaml.safe_load(scene)["rooms"]
    area = sum(area_m2(room["polygon"]) for room in rooms)
    return {"kind": kind, "seed": seed, "drawn": drawn, "area_m2": f"{area:.0f}", "rooms": len(rooms),
            "failed": " ".join(failed), "poor_views_percent": poor.group(1) if poor else "", "cpu_s": f"{used_s:.0f}"}


def read_rows(file):
    if not file.exists():
        return {}
    with file.open(newline="", encoding="utf-8") as stream:
        return {(row["kind"], int(row["seed"])): row for row in csv.DictReader(stream)}


def write_rows(file, rows):
    new = file.with_suffix(".new")
    with new.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows[key] for key in sorted(rows, key=lambda k: (KINDS.index(k[0]), k[1])))
    new.replace(file)


def spread(rows, column, digits=0):
    values = [float(row[column]) for row in rows if row[column]]
    if not values:
        return "-"
    return " / ".join(f"{value:.{digits}f}" for value in (min(values), statistics.median(values), max(values)))


def print_table(rows):
    print("| kind | passed | failed | area m² min / median / max | poor views % | CPU s |")
    print("| --- | --- | --- | --- | --- | --- |")
    for kind in KINDS:
        of_kind = [row for row in rows if row["kind"] == kind]
        if not of_kind:
            continue
        failures = [f"{kind}_{row['seed']}: {row['failed']}" for row in of_kind if row["failed"]]
        print(f"| {kind} | {len(of_kind) - len(failures)} | {'; '.join(failures) or '0'} | {spread(of_kind, 'area_m2')} "
              f"| {spread(of_kind, 'poor_views_percent', 1)} | {spread(of_kind, 'cpu_s')} |")


def check(options):
    file = pathlib.Path(options.file)
    if file.is_dir():
        sys.exit(f"{file} is a folder; wanted is a CSV file")
    if not file.absolute().parent.is_dir():
        sys.exit(f"{file}: there is no folder {file.absolute().parent}; make it first")
    rows, wanted = read_rows(file), []
    for seed in options.seeds:
        for kind in options.kinds:
            scene = draw(kind, seed)
            drawn = hashlib.sha256(scene.encode()).hexdigest()[:12]
            if rows.get((kind, seed), {}).get("drawn") != drawn:
                rows[kind, seed] = check_building(kind, seed, scene, drawn)
                write_rows(file, rows)
                print(f"{kind}_{seed}: {rows[kind, seed]['failed'] or 'passes'}", file=sys.stderr)
            wanted.append(rows[kind, seed])
    print_table(wanted)
    return 1 if any(row["failed"] for row in wanted) else 0


def arguments(documentation):
    """The command line: file, kinds, and seeds for tuning."""
    parser = argparse.ArgumentParser(description=documentation, usage=argparse.SUPPRESS,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file")
    parser.add_argument("--kinds", type=lambda text: text.split(","), default=list(KINDS))
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--count", type=int, default=3)
    options = parser.parse_args()
    if set(options.kinds) - set(KINDS):
        parser.error("kinds are " + ", ".join(KINDS))
    options.seeds = range(options.first, options.first + options.count)
    if options.first < 1 or options.count < 1 or options.seeds[-1] > LAST_TUNING_SEED:
        parser.error(f"seeds for tuning are 1 to {LAST_TUNING_SEED}")
    return options


if __name__ == "__main__":
    sys.exit(check(arguments(__doc__)))
