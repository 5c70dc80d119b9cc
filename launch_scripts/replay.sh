#!/usr/bin/env bash
# Plays a recorded RGB-D data set through slam, semantic_mapper and evaluator.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "$0")/lib.sh"

usage() {
  cat <<'TEXT'
usage: replay.sh DATASET [--out DIR] [--rate X] [--start S] [--duration S] [--labels FILE] [--set KEY=VALUE]...

Plays DATASET (a folder in the layout of the TUM RGB-D benchmark, with camera.yaml) and leaves a run folder with
trajectory, pose graph, semantic map, metrics.json and figures.

  --out DIR        run folder; default: out/<name of DATASET>
  --rate X         speed relative to the recording; default: lock-step, nothing is lost
  --start S        skip S seconds;  --duration S  play S seconds
  --labels FILE    CSV file class_id,class,... that names the labels
  --set KEY=VALUE  configuration, for example semantic_mapper.resolution_m=0.1 or dds.socket_buffer_bytes=212992;
                   it goes to the component that KEY begins with (dds.: to all). --print-config of each process lists the keys
TEXT
}

dataset="" out="" replay=() rate=""
declare -A settings=([sensor_replay]="" [slam]="" [semantic_mapper]="" [evaluator]="")
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --out) out=$2 && shift ;;
    --rate) rate=$2 && replay+=(--rate "$2") && shift ;;
    --start | --duration | --labels) replay+=("$1" "$2") && shift ;;
    --set)
      for name in "${!settings[@]}"; do
        case $2 in
          "$name".* | dds.*) settings[$name]+="--set $2 " ;;
          lockstep.*) [ "$name" != sensor_replay ] || settings[$name]+="--set $2 " ;;
        esac
      done
      shift
      ;;
    -*) die "unknown option $1 (see --help)" ;;
    *) [ -z "$dataset" ] || die "two data sets given: $dataset and $1"; dataset=$1 ;;
  esac
  shift
done
[ -n "$dataset" ] || { usage >&2; exit 2; }
require_build
out=${out:-$repository/out/$(basename "$dataset")}
mkdir -p "$out/logs"
trap end_all EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

declare -A statuses=()
for name in slam semantic_mapper evaluator; do
  # shellcheck disable=SC2086 # one word per setting
  start "$name" --set "$name.output_dir=$out" ${settings[$name]}
  wait_ready "$name" 20
done
[ -z "$rate" ] || replay+=(--set sensor_replay.wait_for_readers=3)
# shellcheck disable=SC2086
"$bin/lapis_sensor_replay" "$dataset" "${replay[@]}" ${settings[sensor_replay]} \
  > >(tee "$out/logs/sensor_replay.log") 2>&1 &
pids+=($!)
names+=(sensor_replay)

# The first child to end is the replay, unless something went wrong.
first="" status=0
wait -n -p first "${pids[@]}" || status=$?
for index in "${!pids[@]}"; do
  [ "${pids[index]}" = "$first" ] || continue
  statuses[$index]=$status
  [ "${names[index]}" = sensor_replay ] || fail_with "${names[index]}" "ended early with status $status"
done
for index in 0 1 2; do end_process $index; done
sed -n '/^exit_reason/,$p' "$out/logs/evaluator.log"
for index in "${!names[@]}"; do
  [ "${statuses[$index]:-0}" = 0 ] || fail_with "${names[index]}" "failed with status ${statuses[$index]}"
done
echo "run folder: $out"
