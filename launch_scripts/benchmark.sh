#!/usr/bin/env bash
# Drives the tours of simulated buildings for several seeds and prints one table.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "$0")/lib.sh"

usage() {
  cat <<'TEXT'
usage: benchmark.sh [--scenes NAME,...] [--runs N] [--out DIR] [--set KEY=VALUE]...

Plays every scene (bundled names or files) with seeds 1 to N through replay.sh, and prints a table with all runs, those
that failed included, and their medians; DIR/runs.csv holds the same. A run that DIR has already from the same
programs and settings is not repeated, so a benchmark that was interrupted goes on where it was.

  --scenes NAME,...  default: apartment,large_building
  --runs N           seeds per scene, default 5
  --out DIR          default: out/benchmark
  --set KEY=VALUE    as for replay.sh
Real-time factors are those of a machine that has nothing else to do: the table names the load it found.
TEXT
}

scenes=apartment,large_building runs=5 out=$repository/out/benchmark settings=()
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --scenes | --runs | --out | --set) [ $# -gt 1 ] || die "$1 needs a value (see --help)" ;;&
    --scenes) scenes=$2 && shift ;;
    --runs) [[ $2 =~ ^[1-9][0-9]*$ ]] || die "--runs $2: wanted is a number of seeds"; runs=$2 && shift ;;
    --out) out=$2 && shift ;;
    --set) settings+=(--set "$2") && shift ;;
    *) die "unknown option $1 (see --help)" ;;
  esac
  shift
done
require_build
export ROS_AUTOMATIC_DISCOVERY_RANGE=${ROS_AUTOMATIC_DISCOVERY_RANGE:-LOCALHOST}
mkdir -p "$out" || die "$out cannot be made a folder; choose another with --out DIR"
read -r load _ </proc/loadavg
folders=()
for scene in ${scenes//,/ }; do
  identity=$(identity_of "$scene" "${settings[@]}")
  for ((seed = 1; seed <= runs; ++seed)); do
    folder=$out/$(basename "$scene" .yaml)_$seed
    [[ " ${folders[*]} " != *" $folder "* ]] || die "two scenes are called $(basename "$scene" .yaml)"
    folders+=("$folder")
    echo "$scene, seed $seed"
    play_once "$folder" "$identity" --scene "$scene" --seed "$seed" "${settings[@]}"
  done
done
echo "load average before: $load"
exec "$repository/launch_scripts/benchmark_table.py" "$out/runs.csv" "${folders[@]}"
