"""What experiment.sh does; see its --help."""

import argparse
import pathlib
import sys

from benchmark_table import id_of, read_table

try:
    from experiments import figures, report, tables
    from experiments.protocol import ProtocolError, read_protocol, run_id, runs_of
    from experiments.runs import Experiment
    from sources import REPOSITORY, hash_of_sources, problem_of_programs
except ModuleNotFoundError as missing:
    sys.exit(f"experiment.sh: no Python module {missing.name}; launch_scripts/setup.sh --dev installs what is needed")


def parse():
    parser = argparse.ArgumentParser(prog="experiment.sh")
    parser.add_argument("protocol")
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--results", type=pathlib.Path)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--table", action="store_true")
    parser.add_argument("--power", action="store_true")
    parser.add_argument("--repeat-failed", action="store_true")
    parser.add_argument("--keys", default="")
    options = parser.parse_args()
    if options.jobs < 1:
        fail("--jobs: wanted is a number of at least 1")
    return options


def fail(text):
    print(f"experiment.sh: {text}", file=sys.stderr)
    sys.exit(2)


def wanted_rows(rows, runs, keys):
    if keys:
        return [row for row in rows if any(row["key"].startswith(key) for key in keys)]
    ids = {run_id(run) for run in runs}
    return [row for row in rows if id_of(row) in ids]


def play(protocol, runs, rows, options):
    """How many runs failed."""
    if problem := problem_of_programs():
        raise ProtocolError(problem)
    known = {id_of(row): row["outcome"] for row in read_table(rows)[1]}
    todo = [run for run in runs if run_id(run) not in known or
            options.repeat_failed and known[run_id(run)] == "FAILED"]
    print(f"{protocol['name']}: {len(runs)} runs, {len(runs) - len(todo)} of them have a row", flush=True)
    out = options.out or REPOSITORY / "out" / "experiments" / protocol["name"]
    experiment = Experiment(protocol, todo, runs[0].scene, rows, out, options.jobs)
    experiment.play()
    return experiment.failures


def main():
    options = parse()
    failures = 0
    try:
        protocol = read_protocol(options.protocol)
        runs = runs_of(protocol, hash_of_sources())
        rows = (options.results or REPOSITORY / "docs" / "results" / protocol["name"]) / "rows.csv"
        if options.power:
            tables.print_power(protocol, len({(run.scene, run.seed) for run in runs}))
            return 0
        if not options.table:
            failures = play(protocol, runs, rows, options)
    except ProtocolError as problem:
        fail(problem)
    keys = [key for key in options.keys.split(",") if key]
    found = wanted_rows(read_table(rows)[1], runs, keys)
    for figure in protocol["figures"]:
        if found and not any(row.get(figure) for row in found):
            print(f"experiment.sh: no row has the figure {figure}", file=sys.stderr)
    tables.print_tables(protocol, found, rows.parent, len(runs))
    if found:
        figures.draw(protocol, found, rows.parent)
        report.write(protocol, options.protocol, found, len(runs), rows.parent)
        print(f"report: {rows.parent / 'report.md'}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
