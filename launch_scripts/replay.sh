#!/usr/bin/env bash
# Plays a recorded RGB-D data set, or a tour of a simulated building, through slam, semantic_mapper and evaluator.
set -euo pipefail
shopt -s extglob
# shellcheck source-path=SCRIPTDIR
source "$(dirname "$0")/lib.sh"

usage() {
  cat <<'TEXT'
usage: replay.sh DATASET|--scene NAME [--out DIR] [--rate X] [--start S] [--duration S] [--labels FILE]
                 [--seed N] [--tour FILE] [--robot FILE]... [--set KEY=VALUE]...

Plays DATASET (a folder in the layout of the TUM RGB-D benchmark, with camera.yaml; what lapis_simulator --export-tum
wrote has the scene's ground truth, too), or drives a robot on a tour through
a simulated building, and leaves a run folder with trajectory, pose graph, semantic map, metrics.json and figures.

  --scene NAME     bundled scene, scene file, or folder of a scanned building (docs/scenes.md)
  --seed N         of the simulator: start, noise, jitter of furniture;  --tour FILE  way-points; default: the scene's
  --robot FILE     robot, after config/robot.yaml (for example config/robot_wide.yaml)
  --out DIR        run folder; default: out/<name of DATASET or scene>
  --rate X         of a data set: speed relative to the recording; of a scene: by the wall clock, X is 1.
                   Default: lock-step, nothing is lost
  --start S        of a data set: skip S seconds;  --duration S  play S seconds
  --labels FILE    of a data set: CSV file class_id,class,... that names the labels
  --set KEY=VALUE  configuration, for example semantic_mapper.resolution_m=0.1 or dds.socket_buffer_bytes=212992;
                   it goes to the component that KEY begins with (dds.: to all; robot.: to all that know the robot).
                   What describes the map and how frames enter it goes from semantic_mapper to the references of evaluator
                   and simulator, too. --print-config of each process lists the keys

Results of an earlier run in DIR are removed, but for the map that slam.resume_from names. Exit status: 0 played to the
end, 1 a process failed or no frame came, 2 bad set-up, 130 and 143 interrupted.
TEXT
}

source=sensor_replay # of the frames
of_data_set=() of_scene=() # options given that the other kind of source does not know
command_line="$*" dataset="" scene="" out="" rate="" play=() requests=() robots=("$repository/config/robot.yaml")
while [ $# -gt 0 ]; do
  case $1 in
    --out | --rate | --start | --duration | --labels | --scene | --seed | --tour | --robot | --set)
      [ $# -gt 1 ] || die "$1 needs a value (see --help)" ;;
  esac
  case $1 in
    -h | --help) usage && exit 0 ;;
    --out) out=$2 && shift ;;
    --rate) rate=$2 && shift ;;
    --scene) scene=$2 source=simulator && shift ;;
    --robot) robots+=("$2") of_scene+=("$1") && shift ;;
    --duration) play+=("$1" "$2") && shift ;;
    --start | --labels) play+=("$1" "$2") of_data_set+=("$1") && shift ;;
    --seed | --tour) play+=("$1" "$2") of_scene+=("$1") && shift ;;
    --set) requests+=("$2") && shift ;;
    -*) die "unknown option $1 (see --help)" ;;
    *) [ -z "$dataset" ] || die "two data sets given: $dataset and $1"; dataset=$1 ;;
  esac
  shift
done
[ -n "$dataset$scene" ] || { usage >&2; exit 2; }
[ -z "$dataset" ] || [ -z "$scene" ] || die "a data set and a scene given: $dataset and $scene"
[ -z "$scene" ] || [ ${#of_data_set[@]} -eq 0 ] || die "${of_data_set[0]} is of data sets, and a scene is given"
[ -n "$scene" ] || [ ${#of_scene[@]} -eq 0 ] || die "${of_scene[0]} is of scenes, and a data set is given"
[ -z "$scene" ] || [ -z "$rate" ] || [ "$rate" = 1 ] || die "--rate $rate: a scene runs by the wall clock (1) or in lock-step"
[ -n "$scene" ] || [ -d "$dataset" ] || die "$dataset: no such folder (wanted is a TUM RGB-D data set)"
require_build

components=(slam semantic_mapper evaluator "$source") settings=() # settings: component, KEY=VALUE, component, ...
add_setting() {
  case $1 in
    dds.*=*) for name in "${components[@]}"; do settings+=("$name" "$1"); done ;;
    robot.*=*) for name in "${components[@]}"; do ! knows_robot "$name" || settings+=("$name" "$1"); done ;;
    lockstep.*=*) settings+=("$source" "$1") ;;
    semantic_mapper.sensor_model.*=*) settings+=(semantic_mapper "$1" evaluator "evaluator.${1#*.}") ;;
    semantic_mapper.@(resolution_m|integration.*|frame.*)=*)
      settings+=(semantic_mapper "$1" evaluator "evaluator.${1#*.}")
      [ "$source" != simulator ] || settings+=(simulator "simulator.truth.${1#*.}") ;;
    sensor_replay.*=* | simulator.*=*)
      [ "$source" = "${1%%.*}" ] || die "--set $1: no ${1%%.*} in this run"
      settings+=("$source" "$1") ;;
    slam.*=* | semantic_mapper.*=* | evaluator.*=*) settings+=("${1%%.*}" "$1") ;;
    *) die "--set $1: unknown key; wanted is KEY=VALUE, KEY begins with dds., lockstep., robot., ${components[*]/%/.}" ;;
  esac
}
knows_robot() { [ "$1" = semantic_mapper ] || [ "$1" = evaluator ] || [ "$1" = simulator ]; }
resumed="" # map that slam goes on with
for request in "${requests[@]}"; do
  add_setting "$request"
  [[ $request != slam.resume_from=* ]] || resumed=${request#*=}
done

out=${out:-$repository/out/$(basename "${dataset:-$scene}" .yaml)}
mkdir -p "$out/logs" || die "$out cannot be made a run folder; choose another with --out DIR"
(
  cd "$out"
  rm -f manifest.yaml simulation.yaml metrics.json timeline.csv trajectory_{estimate,ground_truth}.txt \
    reference_map.lapis {keyframes,pose_graph,map}?(.+([0-9])).{txt,g2o,lapis,ot,ply} \
    ground_truth/{mesh,flood,ideal}.lapis ground_truth/{classes,rooms}.json ground_truth/navmap.{png,yaml} \
    figures/{trajectory,errors,class_iou}.png logs/{slam,semantic_mapper,evaluator,sensor_replay,simulator}.log
)
for file in "$out"/slam?(.+([0-9])).lapis; do
  [ "$file" -ef "$resumed" ] || rm -f "$file"
done
if [ "$source" = simulator ]; then
  play=("$scene" --set simulator.tour=bundled "${play[@]}" --set "simulator.output_dir=$out")
  [ -z "$rate" ] || play+=(--mode freerun --set simulator.wait_for_readers=3)
else
  play=("$dataset" "${play[@]}")
  [ ! -d "$dataset/ground_truth" ] || settings=(evaluator "evaluator.ground_truth_dir=$dataset/ground_truth" "${settings[@]}")
  [ -z "$rate" ] || play+=(--rate "$rate" --set sensor_replay.wait_for_readers=3)
fi

# Sets `arguments` to the command line of a component.
collect_arguments() {
  local i robot
  if [ "$1" = "$source" ]; then arguments=("${play[@]}"); else arguments=(--set "$1.output_dir=$out"); fi
  if knows_robot "$1"; then for robot in "${robots[@]}"; do arguments+=(--config "$robot"); done; fi
  for ((i = 0; i < ${#settings[@]}; i += 2)); do
    [ "${settings[i]}" != "$1" ] || arguments+=(--set "${settings[i + 1]}")
  done
}

write_manifest() {
  local name
  {
    printf 'version: "%s"\ncommand: |-\n  replay.sh %s\n%s: "%s"\nexit_status:\n' \
      "$("$bin/lapis_slam" --version)" "$command_line" "${scene:+scene}${dataset:+data_set}" "$dataset$scene"
    for name in "${names[@]}"; do echo "  $name: ${statuses[$name]:-null}"; done
    if [ -f "$out/simulation.yaml" ]; then echo "simulation:" && sed 's/^/  /' "$out/simulation.yaml"; fi
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
collect_arguments "$source"
start_shown "$source" "${arguments[@]}"

# The first child to end is the source, unless something went wrong.
wait_first
early=${names[first]}
end_all
write_manifest
[ "$early" = "$source" ] || fail_with "$early" "ended early with status ${statuses[$early]}"
print_metrics
for name in "$source" slam semantic_mapper evaluator; do
  [ "${statuses[$name]}" = 0 ] || fail_with "$name" "failed with status ${statuses[$name]}" "${statuses[$name]}"
done
[ -f "$out/metrics.json" ] || fail_with slam "no frame came; the reason may be here or in the other logs"
echo "run folder: $out"
