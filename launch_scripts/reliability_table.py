#!/usr/bin/env python3
"""Prints docs/reliability.md: what Lapis promises when something fails, and what became of it in a run of the tests.

usage: reliability_table.py FAULTS RESULTS COMMIT

FAULTS is tests/faults/faults.json, RESULTS what ctest --output-junit wrote, COMMIT that of the programs. A test states a
figure by a line "figure: TEXT" in its output. launch_scripts/test.sh --tier faults calls this script.
"""
import datetime
import json
import os
import pathlib
import re
import sys
import xml.etree.ElementTree

import usage

HEAD = """# Reliability

What becomes of Lapis when something around it fails, tested. `launch_scripts/test.sh --tier faults` runs the commands at the end of this page and
writes it; `tests/faults/faults.json` says what is promised, what tests it, and what is left out.

Last run: commit {commit}, {date}, {cores} cores that may have had other work; {seconds:.0f} s for {count} commands.
{states}

The commands are cases of the tests of other tiers, so `.ci/run` runs them, too, except {long}.
"""
STATES = ("holds", "in part", "does not hold", "FAILS", "no test yet")
RESULTS = {"run": "passed", "fail": "FAILED", "notrun": "skipped", "disabled": "skipped"}


def results_of(file):
    """By test: result, seconds, figures."""
    results = {}
    for case in xml.etree.ElementTree.parse(file).getroot().iter("testcase"):
        figures = re.findall(r"figure: (.*)", case.findtext("system-out") or "")
        results[case.get("name").removeprefix("faults.")] = (RESULTS[case.get("status")], float(case.get("time")), figures)
    return results


def state_of(fault, results):
    outcomes = {results[test][0] for test in fault["tests"]}
    if "FAILED" in outcomes:
        return "FAILS"
    if not fault.get("holds", True):
        return "does not hold"
    if not outcomes and "elsewhere" not in fault:
        return "no test yet"
    return "in part" if fault["missing"] or outcomes != {"passed"} else "holds"


def fault_row(fault, results):
    skipped = [f"`{test}`" for test in fault["tests"] if results[test][0] == "skipped"]
    missing = [fault["missing"], f"Skipped here: {', '.join(skipped)}." if skipped else ""]
    tests = ", ".join(f"`{test}`" for test in fault["tests"]) or fault.get("elsewhere", "")
    return f"| {fault['name']} | {fault['promise']} | {state_of(fault, results)} | {tests} | {' '.join(filter(None, missing))} |"


def command_line(command):
    program = "build/release/bin/"
    return f"{program}lapis_in_private_domain {command}" if ".py" in command.split()[0] else program + command


def command_row(name, command, result):
    outcome, seconds, figures = result
    return f"| `{name}` | `{command_line(command)}` | {outcome} | {seconds:.1f} | {'; '.join(figures)} |"


def table(*headings):
    return "\n".join(("| " + " | ".join(headings) + " |", "|" + " --- |" * len(headings)))


def main():
    faults, results, commit = usage.arguments(__doc__, least=3)
    faults = json.loads(pathlib.Path(faults).read_text(encoding="utf-8"))
    results = results_of(results)
    absent = sorted(set(faults["tests"]) - set(results))
    if absent:
        sys.exit(f"no results of {', '.join(absent)}")
    states = [state_of(fault, results) for fault in faults["faults"]]
    long = [f"`{name}`" for name, command in faults["tests"].items() if " Long" in command]
    print(HEAD.format(commit=commit, date=datetime.datetime.now(datetime.timezone.utc).date(), cores=os.cpu_count(),
                      seconds=sum(results[test][1] for test in faults["tests"]), count=len(faults["tests"]),
                      states=f"Of {len(states)} promises: " + ", ".join(f"{state} {states.count(state)}" for state in STATES) + ".",
                      long=", ".join(long) or "none"))
    print("## What is promised\n\n" + table("", "fault and limit", "state", "tests", "what is not tested, or does not hold"))
    for fault in faults["faults"]:
        print(fault_row(fault, results))
    print("\n## Faults that were found\n\nBy attacks on an earlier version, and the tests that show that they are gone.\n\n" +
          table("", "what happened", "state", "tests", "what is not tested"))
    for fault in faults["found"]:
        print(fault_row(fault, results))
    print("\n## Commands\n\nThey want `ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST`.\n\n" +
          table("test", "command", "result", "seconds", "figure"))
    for name, command in faults["tests"].items():
        print(command_row(name, command, results[name]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
