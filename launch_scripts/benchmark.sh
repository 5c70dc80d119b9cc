#!/usr/bin/env bash
# Runs methods in scenes with several seeds, and prints one table.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "$0")/lib.sh"

usage() {
  cat <<'TEXT'
usage: benchmark.sh [--scenes NAME[:S],...] [--methods METHOD,...] [--runs N] [--out DIR] [--world FILE]
                    [--set KEY=VALUE]...

Runs every scene (bundled names, generated buildings, or files) with every method and seeds 1 to N, and prints a table with all runs, those
that failed included, and their medians. DIR has the same as runs.csv, box plots and the explored share over time as
figures/*.png, and the run folders. A run that DIR has already from the same programs and settings is not repeated, so a
benchmark that was interrupted continues where it was.

  --scenes NAME[:S],...  S: simulated seconds of exploration, 300 unless given (a tour takes the time that it takes);
                         default: apartment:300,large_building:600
  --methods METHOD,...   as for explore.sh; or tour (default): the robot drives the scene's tour, by replay.sh
  --runs N               seeds per scene and method, default 5
  --out DIR              default: out/benchmark
  --world FILE           as for explore.sh and replay.sh
  --set KEY=VALUE        as for explore.sh and replay.sh
Real-time factors are those of a machine that has nothing else to do: the table names the load it found. Exit status:
0 all runs succeeded, 1 a run failed (it is in the table as FAILED, and is repeated the next time), 2 bad options,
130 and 143 interrupted.
TEXT
}

scenes=apartment:300,large_building:600 methods=tour runs=5 out=$repository/out/benchmark settings=() world=""
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --scenes | --methods | --runs | --out | --world | --set) [ $# -gt 1 ] || die "$1 needs a value (see --help)" ;;&
    --scenes) scenes=$2 && shift ;;
    --methods) methods=$2 && shift ;;
    --runs) [[ $2 =~ ^[1-9][0-9]*$ ]] || die "--runs $2: wanted is a number of seeds"; runs=$2 && shift ;;
    --out) out=$2 && shift ;;
    --world)
      world+=$(sha256sum 2>/dev/null <"$2" | cut -c 1-16) || die "--world $2: no file that can be read"
      settings+=(--world "$2") && shift ;;
    --set) settings+=(--set "$2") && shift ;;
    *) die "unknown option $1 (see --help)" ;;
  esac
  shift
done
require_build
for method in ${methods//,/ }; do # bad set-up shows before hours of work
  [ "$method" = tour ] || "$bin/lapis_planner" --set "planner.method=$method" --check-config >/dev/null || exit 2
done
export ROS_AUTOMATIC_DISCOVERY_RANGE=${ROS_AUTOMATIC_DISCOVERY_RANGE:-LOCALHOST}
lock_folder "$out"
read -r load _ </proc/loadavg
folders=()

# benchmark SCENE SECONDS METHOD: all seeds.
benchmark() {
  local scene=$1 method=$3 command=(explore.sh --method "$3" --duration "$2") identity folder seed
  [ "$method" != tour ] || command=(replay.sh)
  identity=$(identity_of "$scene" "${command[@]}" "${settings[@]}" ${world:+"$world"})
  for ((seed = 1; seed <= runs; ++seed)); do
    folder=$out/$(basename "$scene" .yaml)/$method/seed_$seed
    [[ " ${folders[*]} " != *" $folder "* ]] || die "two scenes or methods are called $(basename "$scene" .yaml), $method"
    folders+=("$folder")
    echo "$scene, $method, seed $seed"
    mkdir -p "$(dirname "$folder")"
    play_once "$folder" "$identity" "${command[@]}" --scene "$scene" --seed "$seed" "${settings[@]}"
  done
}

IFS=, read -ra entries <<<"$scenes"
for entry in "${entries[@]}"; do
  seconds=300
  if [[ $entry =~ :([0-9]+)$ ]]; then seconds=${BASH_REMATCH[1]}; fi
  for method in ${methods//,/ }; do benchmark "${entry%:"$seconds"}" "$seconds" "$method"; done
done
echo "load average before: $load"
"$repository/launch_scripts/benchmark_figures.py" "$out" "${folders[@]}"
exec "$repository/launch_scripts/benchmark_table.py" "$out/runs.csv" "${folders[@]}"
