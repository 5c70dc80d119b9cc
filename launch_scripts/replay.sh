#!/usr/bin/env bash
# Plays a recorded RGB-D data set through slam, semantic_mapper and evaluator.
set -euo pipefail
shopt -s extglob
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
                   it goes to the component that KEY begins with (dds.: to all). What describes the map and how frames
                   enter it goes from semantic_mapper to the evaluator's reference, too. --print-config of each process
                   lists the keys

Results of an earlier run in DIR are removed. Exit status: 0 played to the end, 1 a process failed or no frame came,
2 bad set-up, 130 and 143 interrupted.
TEXT
}

components=(slam semantic_mapper evaluator sensor_replay)
command_line="$*" dataset="" out="" rate="" replay=() settings=() # settings: component, KEY=VALUE, component, ...
add_setting() {
  case $1 in
    dds.*=*) for name in "${components[@]}"; do settings+=("$name" "$1"); done ;;
    lockstep.*=*) settings+=(sensor_replay "$1") ;;
    semantic_mapper.@(resolution_m|integration.*|frame.*|sensor_model.*)=*)
      settings+=(semantic_mapper "$1" evaluator "evaluator.${1#*.}") ;;
    sensor_replay.*=* | slam.*=* | semantic_mapper.*=* | evaluator.*=*) settings+=("${1%%.*}" "$1") ;;
    *) die "--set $1: unknown key; wanted is KEY=VALUE, KEY begins with dds., lockstep., ${components[*]/%/.}" ;;
  esac
}
while [ $# -gt 0 ]; do
  case $1 in
    --out | --rate | --start | --duration | --labels | --set) [ $# -gt 1 ] || die "$1 needs a value (see --help)" ;;
  esac
  case $1 in
    -h | --help) usage && exit 0 ;;
    --out) out=$2 && shift ;;
    --rate) rate=$2 && replay+=(--rate "$2") && shift ;;
    --start | --duration | --labels) replay+=("$1" "$2") && shift ;;
    --set) add_setting "$2" && shift ;;
    -*) die "unknown option $1 (see --help)" ;;
    *) [ -z "$dataset" ] || die "two data sets given: $dataset and $1"; dataset=$1 ;;
  esac
  shift
done
[ -n "$dataset" ] || { usage >&2; exit 2; }
[ -d "$dataset" ] || die "$dataset: no such folder (wanted is a TUM RGB-D data set)"
require_build
out=${out:-$repository/out/$(basename "$dataset")}
mkdir -p "$out/logs" || die "$out cannot be made a run folder; choose another with --out DIR"
(
  cd "$out"
  rm -f manifest.yaml metrics.json timeline.csv trajectory_{estimate,ground_truth}.txt reference_map.lapis \
    {keyframes,pose_graph,map}?(.+([0-9])).{txt,g2o,lapis,ot,ply} \
    figures/{trajectory,errors,class_iou}.png logs/{slam,semantic_mapper,evaluator,sensor_replay}.log
)
[ -z "$rate" ] || replay+=(--set sensor_replay.wait_for_readers=3)

# Sets `arguments` to the command line of a component.
collect_arguments() {
  local i
  if [ "$1" = sensor_replay ]; then arguments=("$dataset" "${replay[@]}"); else arguments=(--set "$1.output_dir=$out"); fi
  for ((i = 0; i < ${#settings[@]}; i += 2)); do
    [ "${settings[i]}" != "$1" ] || arguments+=(--set "${settings[i + 1]}")
  done
}

write_manifest() {
  local name
  {
    printf 'version: "%s"\ncommand: |-\n  replay.sh %s\ndata_set: "%s"\nexit_status:\n' \
      "$("$bin/lapis_slam" --version)" "$command_line" "$dataset"
    for name in "${names[@]}"; do echo "  $name: ${statuses[$name]:-null}"; done
    echo "configuration:"
    for name in "${components[@]}"; do
      collect_arguments "$name"
      echo "  $name:"
      "$bin/lapis_$name" "${arguments[@]}" --print-config | sed 's/^/    /'
    done
  } >"$out/manifest.yaml.part" && mv "$out/manifest.yaml.part" "$out/manifest.yaml"
}

print_metrics() { [ ! -f "$out/metrics.json" ] || sed -n '/^exit_reason/,$p' "$out/logs/evaluator.log"; }

interrupted() {
  trap '' INT TERM
  end_all
  write_manifest
  print_metrics
  echo "replay.sh: interrupted by $1; what was played is in $out" >&2
  exit "$2"
}

trap end_all EXIT
trap 'interrupted SIGINT 130' INT
trap 'interrupted SIGTERM 143' TERM

for name in slam semantic_mapper evaluator; do
  collect_arguments "$name"
  start "$name" "${arguments[@]}"
  wait_ready "$name" 20
done
collect_arguments sensor_replay
start_shown sensor_replay "${arguments[@]}"

# The first child to end is the replay, unless something went wrong.
wait_first
early=${names[first]}
end_all
write_manifest
[ "$early" = sensor_replay ] || fail_with "$early" "ended early with status ${statuses[$early]}"
print_metrics
for name in sensor_replay slam semantic_mapper evaluator; do
  [ "${statuses[$name]}" = 0 ] || fail_with "$name" "failed with status ${statuses[$name]}" "${statuses[$name]}"
done
[ -f "$out/metrics.json" ] || fail_with slam "no frame came; the reason may be here or in the other logs"
echo "run folder: $out"
