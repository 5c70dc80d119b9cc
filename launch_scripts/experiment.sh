#!/usr/bin/env bash
# Runs an experiment as its protocol says, and prints its tables.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "$0")/lib.sh"

usage() {
  cat <<'TEXT'
usage: experiment.sh PROTOCOL.yaml [--out DIR] [--results DIR] [--jobs N] [--table] [--power] [--repeat-failed]
                     [--keys KEY,...]

Runs every method of a protocol in every building, all methods of a building before the next, and prints tables with
paired tests; beside the rows are these as Markdown, CSV and LaTeX, figures, and a report. Each run is a row of rows.csv
in docs/results/NAME as soon as it has ended, with a key (hash of the sources and of the configuration that its results
depend on). What has a row of the same key is not repeated: an experiment resumes where its rows end, on another
machine, too. A run that fails or is killed is a row, too, and counts as a failure.
One that cannot start as the protocol says ends the experiment.

  --out DIR        run folders; default: out/experiments/NAME
  --results DIR    rows and tables; default: docs/results/NAME
  --jobs N         runs side by side, each on a core of its own and with a DDS domain of its own, from ROS_DOMAIN_ID (or
                   0) on; default: 1
  --table          no runs: the tables of the rows that are there
  --power          no runs: the power of the protocol's tests, by simulation
  --repeat-failed  run again what has failed
  --keys KEY,...   tables of rows with these keys (or what they begin with); default: those of the sources as they are

A protocol (config/protocols has examples) says:
  name, title      its name, and what is asked
  world            file of config/worlds; without it robot and camera as configured
  buildings        list of {names: 'flat_[1-8]', duration_s: 300}
  seeds            list; default [1]
  methods          label: {method: mi_only, then: nearest, settings: {KEY: VALUE}}
  settings         of all runs: {KEY: VALUE}
  failed_below     {explored_share: 0.8}: a run that ends with less has failed
  figures          columns of the table, as in metrics.json
  tests            list of {figure, method, against, ratio or difference (what is expected), deviation (of the paired
                   logarithms or differences, for --power)}: two-sided Wilcoxon tests of pairs, Holm's correction over all
  conditions       list of {figure, method, against, least_ratio}: one-sided 95 % bound of the median ratio

Exit status: 0 done, 1 a run failed, 2 bad set-up, 130 and 143 interrupted.
TEXT
}

protocol="" options=()
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --out | --results | --jobs | --keys)
      [ $# -gt 1 ] || die "$1 needs a value (see --help)"
      options+=("$1" "$2") && shift ;;
    --table | --power | --repeat-failed) options+=("$1") ;;
    -*) die "unknown option $1 (see --help)" ;;
    *)
      [ -z "$protocol" ] || die "$1: one protocol only"
      protocol=$1 ;;
  esac
  shift
done
[ -n "$protocol" ] || die "wanted is a protocol (see --help)"
[[ " ${options[*]} " == *" --table "* || " ${options[*]} " == *" --power "* ]] || require_build
export ROS_AUTOMATIC_DISCOVERY_RANGE=${ROS_AUTOMATIC_DISCOVERY_RANGE:-LOCALHOST}
PYTHONPATH=$repository/launch_scripts exec /usr/bin/python3 -B -m experiments "$protocol" "${options[@]}"
