#!/usr/bin/env bash
# What the chain costs: CPU time per frame and process, frames lost in real time, and all benchmarks of kernels.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "$0")/lib.sh"

usage() {
  cat <<'TEXT'
usage: bench.sh [DATASET] [--runs N] [--out DIR]
  DATASET    recorded RGB-D; default: rgbd/aws_small_house_loop in LAPIS_TEST_DATA
  --runs N   lock-step replays of which the median is printed; default 3; 0: kernels only
  --out DIR  keeps results as JSON, and decision_time.png; default: out/bench. All *.json files that are in it
             are removed first
Builds programs and benchmarks (target benchmarks) first. Run it on a machine that has nothing else to do: the table names the load it found. What needs data that is not there
is skipped, and reported at the end. Exit status 1 when a benchmark failed, 2 when a replay did.
TEXT
}

data=${LAPIS_TEST_DATA:-$repository/../shared/data}
dataset=$data/rgbd/aws_small_house_loop runs=3 out=$repository/out/bench
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --runs | --out) [ $# -gt 1 ] || die "$1 needs a value (see --help)" ;;&
    --runs) runs=$2 && shift ;;
    --out) out=$2 && shift ;;
    -*) die "unknown option $1 (see --help)" ;;
    *) dataset=$1 ;;
  esac
  shift
done
[[ $runs =~ ^[0-9]+$ ]] || die "--runs $runs: wanted is a number"
if [ -z "${LAPIS_BIN:-}" ]; then
  "$repository/launch_scripts/setup.sh" --dev --no-build
  cd "$repository"
  cmake --preset release -D BUILD_TESTING=ON >/dev/null
  cmake --build --preset release --target programs benchmarks
  cd "$OLDPWD"
fi
require_build
export ROS_AUTOMATIC_DISCOVERY_RANGE=${ROS_AUTOMATIC_DISCOVERY_RANGE:-LOCALHOST}
mkdir -p "$out" || die "$out cannot be made a folder; choose another with --out DIR"
rm -f "$out"/*.json
read -r load _ </proc/loadavg
troubles=() # what failed or was skipped

trouble() { troubles+=("$*") && echo "$*" >&2; }

play() { # NAME OPTION...
  local name=$1
  shift
  "$repository/launch_scripts/replay.sh" "$dataset" --out "$out/$name" --set evaluator.figures=false "$@" \
    >"$out/$name.log" 2>&1 || { tail -n 5 "$out/$name.log" >&2 && die "$name failed"; }
}

print_chain() {
  local run
  for ((run = 1; run <= runs; ++run)); do play "lockstep_$run"; done
  play real_time --rate 1
  python3 - "$out" "$runs" "$load" <<'PYTHON'
import json, re, statistics, sys
out, runs, load = sys.argv[1], int(sys.argv[2]), sys.argv[3]
metrics = [json.load(open(f"{out}/lockstep_{run + 1}/metrics.json")) for run in range(runs)]
log = lambda name: open(f"{out}/real_time/logs/{name}.log").read()
total = int(re.search(r": (\d+) frames, ", log("sensor_replay"))[1])
done = {"slam": int(re.search(r"(\d+) of \d+ frames tracked", log("slam"))[1]),
        "semantic_mapper": int(re.search(r"(\d+) frames integrated", log("semantic_mapper"))[1])}
print(f"{metrics[0]['frames_total']} frames, lock-step: median of {runs}; load before: {load}")
print(f"{'process':18}{'CPU ms/frame':>14}{'peak RSS MB':>14}{'lost at --rate 1':>20}")
for name in metrics[0]["cpu_ms_per_frame"]:
    cpu, memory = (statistics.median(m[key][name] for m in metrics) for key in ("cpu_ms_per_frame", "peak_rss_mb"))
    lost = f"{total - done[name]} of {total}" if name in done else ""
    print(f"{name:18}{cpu:14.1f}{memory:14.0f}{lost:>20}")
PYTHON
}

if [ "$runs" -gt 0 ] && [ -d "$dataset" ]; then
  print_chain
elif [ "$runs" -gt 0 ]; then
  trouble "SKIPPED: CPU time of the chain; $dataset is no folder: name a data set, or set LAPIS_TEST_DATA"
fi

# Google Benchmarks go into one table; the others print their own.
others=()
for benchmark in "$bin"/lapis_*_benchmark; do
  name=$(basename "$benchmark")
  if ! "$benchmark" --benchmark_list_tests >/dev/null 2>&1; then others+=("$name") && continue; fi
  echo "$name" >&2
  "$benchmark" --benchmark_min_time=0.2 --benchmark_out="$out/$name.json" >"$out/$name.log" 2>&1 ||
    { rm -f "$out/$name.json" && tail -n 5 "$out/$name.log" >&2 && trouble "FAILED: $name"; }
done
printf '\nkernels, load before: %s\n' "$load"
"$repository/launch_scripts/bench_table.py" "$out"/*.json || trouble "FAILED: benchmarks that the table names"
"$repository/launch_scripts/bench_figure.py" "$out/decision_time.png" "$out"/*.json || trouble "FAILED: bench_figure.py"
for name in "${others[@]}"; do
  arguments=()
  if [ "$name" = lapis_pose_graph_benchmark ]; then
    if [ ! -d "$data/posegraph" ]; then trouble "SKIPPED: $name; no folder $data/posegraph" && continue; fi
    arguments=("$data/posegraph")
  fi
  printf '\n%s\n' "$name"
  "$bin/$name" "${arguments[@]}" || trouble "FAILED: $name"
done
[ ${#troubles[@]} -eq 0 ] || printf '%s\n' "" "${troubles[@]}"
[[ " ${troubles[*]}" != *" FAILED:"* ]]
