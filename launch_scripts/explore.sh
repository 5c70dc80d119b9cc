#!/usr/bin/env bash
# Explores a simulated building: the robot decides by itself where to go, and maps what it sees.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "$0")/lib.sh"

usage() {
  cat <<'TEXT'
usage: explore.sh [--scene NAME|DIR] [--method METHOD] [--duration S] [--seed N] [--out DIR] [--robot FILE]...
                  [--world FILE]... [--then HOW] [--no-preset] [--segmenter MODEL] [--record BAG] [--freerun] [--restart]
                  [--set KEY=VALUE]...

Lets the robot explore a simulated building until nothing reachable is left or the time is up, and leaves a run folder
with trajectory, pose graph, semantic map, decisions.csv, metrics.json and figures.

  --scene NAME     bundled scene, generated building (office_7: docs/buildings.md), scene file, or folder of a scanned
                   building (docs/scenes.md); default: apartment
  --method METHOD  that chooses where to go: lapis (default), paper, ssmi, tare, nearest, mi_only, dopt_only, placed,
                   fixed_n or joint (components/planner/README.md); with the settings of config/methods/METHOD,
                   where there is such a folder
  --no-preset      without these settings: the method's utility alone
  --then HOW       the run lasts for --duration, and when nothing is left before that the robot stands (none), or drives
                   through old places, so that loops are closed: the nearest, random ones, or the best by method lapis
  --duration S     simulated seconds after which the run ends; default: 300 (large_building needs 600)
  --seed N         of the simulator: start, noise, jitter of furniture; default: 1
  --out DIR        run folder; default: out/<name of scene>_<method>_<seed>
  --robot FILE     robot, after config/robot.yaml (for example config/robot_wide.yaml); or a folder of such files
                   (config/robot_without_odometry)
  --world FILE     what wheels and camera are like (config/worlds, docs/buildings.md)
  --segmenter MODEL  labels by a network (components/segmenter/README.md) instead of those of the scene
  --record BAG     all topics into a bag of rosbag2, a new folder (components/recorder/README.md)
  --freerun        by the wall clock, frames may be lost; default: lock-step
  --restart        a process that dies or hangs is started again, at most three times each, but for the simulator; what
                   is lost with it: docs/architecture.md
  --set KEY=VALUE  configuration, as for replay.sh; planner. and controller. are components, too

The processes meet on this host only, unless ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS or ROS_DISCOVERY_SERVER
says otherwise (docs/ros2.md).
Results of an earlier run in DIR are removed, but for the maps that slam.resume_from and semantic_mapper.resume_from
name. Exit status: 0 ran to the end, 1 a process failed or no frame came, 2 bad set-up, 130 and 143 interrupted; then,
too, everything up to there is in DIR, but for the figures.
TEXT
}

# add_config PATH: adds a file of configuration, or all of a folder, to `options`.
add_config() {
  local file
  if [ ! -d "$1" ]; then options+=(--config "$1") && return; fi
  for file in "$1"/*.yaml; do options+=(--config "$file"); done
}

[ -n "${ROS_DISCOVERY_SERVER:-}" ] || export ROS_AUTOMATIC_DISCOVERY_RANGE=${ROS_AUTOMATIC_DISCOVERY_RANGE:-LOCALHOST}
command="${0##*/} $*" scene=apartment method=lapis duration=300 seed=1 out="" afterwards="" has_preset=1 options=() recording=()
while [ $# -gt 0 ]; do
  case $1 in
    --scene | --method | --duration | --seed | --out | --robot | --world | --then | --segmenter | --record | --set)
      [ $# -gt 1 ] || die "$1 needs a value (see --help)" ;;
  esac
  case $1 in
    -h | --help) usage && exit 0 ;;
    --scene) scene=$2 && shift ;;
    --method) method=$2 && shift ;;
    --duration) duration=$2 && shift ;;
    --seed) seed=$2 && shift ;;
    --out) out=$2 && shift ;;
    --robot | --world) add_config "$2" && shift ;;
    --then) afterwards=$2 && options+=(--set "planner.then=$2" --set simulator.ends_when_explored=false) && shift ;;
    --no-preset) has_preset=0 ;;
    --segmenter) options+=(--variant segmented --set "segmenter.model=$2") && shift ;;
    --record) recording=(--variant recorded --set "recorder.output=$(realpath -m "$2")") && shift ;;
    --freerun) options+=(--variant freerun) ;;
    --restart) options+=(--restart) ;;
    --set) options+=(--set "$2") && shift ;;
    *) die "unknown argument $1 (see --help)" ;;
  esac
  shift
done
[ -z "$afterwards" ] || [[ ! $duration =~ ^0*\.?0*$ ]] || die "--then without an end: give a --duration"
require_build
for preset in "$repository/config/methods/$method"/*.yaml; do
  if [ $has_preset -eq 1 ] && [ -f "$preset" ]; then options=(--config "$preset" "${options[@]}"); fi
done
out=${out:-$repository/out/$(basename "$scene" .yaml)_${method}_$seed}
echo "explores $scene by method $method with seed $seed; logs: $out/logs"
run_system explore "$command" --out "$out" --set "simulator.scene=$scene" --set "planner.method=$method" \
  --set "simulator.seed=$seed" --set "simulator.duration_s=$duration" "${options[@]}" "${recording[@]}"
