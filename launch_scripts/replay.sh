#!/usr/bin/env bash
# Plays a recorded RGB-D data set, or a tour of a simulated building, through slam, semantic_mapper and evaluator.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "$0")/lib.sh"

usage() {
  cat <<'TEXT'
usage: replay.sh DATASET|--scene NAME [--out DIR] [--rate X] [--start S] [--duration S] [--labels FILE]
                 [--seed N] [--tour FILE] [--robot FILE]... [--world FILE]...
                 [--segmenter MODEL] [--record BAG] [--restart] [--set KEY=VALUE]...

Plays DATASET (a folder in the layout of the TUM RGB-D benchmark, with camera.yaml, or a bag of rosbag2: its folder, or a
.mcap or .db3; what lapis_simulator --export-tum
wrote has the scene's ground truth, too), or drives a robot on a tour through
a simulated building, and leaves a run folder with trajectory, pose graph, semantic map, metrics.json and figures.

  --scene NAME     bundled scene, generated building (office_7: docs/buildings.md), scene file, or folder of a scanned
                   building (docs/scenes.md)
  --seed N         of the simulator: start, noise, jitter of furniture;  --tour FILE  waypoints; default: the scene's
  --robot FILE     robot, after config/robot.yaml (for example config/robot_wide.yaml)
  --world FILE     of a scene: what wheels and camera are like (config/worlds, docs/buildings.md)
  --out DIR        run folder; default: out/<name of DATASET or scene>
  --rate X         of a data set: speed relative to the recording; of a scene: by the wall clock, X is 1.
                   Default: lock-step, nothing is lost
  --start S        of a data set: skip S seconds;  --duration S  play S seconds
  --labels FILE    of a data set: CSV file class_id,class,... that names the labels
  --segmenter MODEL  labels by a network (components/segmenter/README.md) instead of those of the data set or scene
  --record BAG     all topics into a bag of rosbag2, a new folder (components/recorder/README.md)
  --restart        a process that dies or hangs is started again, as by explore.sh
  --set KEY=VALUE  configuration, for example semantic_mapper.resolution_m=0.1 or dds.socket_buffer_bytes=212992; it goes
                   to every process that knows KEY. --print-config of each process lists its keys

The processes meet on this host only, unless ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS or ROS_DISCOVERY_SERVER
says otherwise (docs/ros2.md).
Results of an earlier run in DIR are removed, but for the maps that slam.resume_from and semantic_mapper.resume_from
name. Exit status: 0 played to the end, 1 a process failed or no frame came, 2 bad set-up, 130 and 143 interrupted.
TEXT
}

of_data_set=() of_scene=() # options given that the other kind of source does not know
[ -n "${ROS_DISCOVERY_SERVER:-}" ] || export ROS_AUTOMATIC_DISCOVERY_RANGE=${ROS_AUTOMATIC_DISCOVERY_RANGE:-LOCALHOST}
command="${0##*/} $*" dataset="" scene="" rate="" out="" duration="" options=() recording=()
while [ $# -gt 0 ]; do
  case $1 in
    --out | --rate | --start | --duration | --labels | --scene | --seed | --tour | --robot | --world | --segmenter | --record | --set)
      [ $# -gt 1 ] || die "$1 needs a value (see --help)" ;;
  esac
  case $1 in
    -h | --help) usage && exit 0 ;;
    --out) out=$2 && shift ;;
    --rate) rate=$2 && shift ;;
    --scene) scene=$2 && shift ;;
    --duration) duration=$2 && shift ;;
    --robot | --world) options+=(--config "$2") of_scene+=("$1") && shift ;;
    --start) options+=(--set "sensor_replay.start_s=$2") of_data_set+=("$1") && shift ;;
    --labels) options+=(--set "sensor_replay.class_list=$2") of_data_set+=("$1") && shift ;;
    --seed | --tour) options+=(--set "simulator.${1#--}=$2") of_scene+=("$1") && shift ;;
    --segmenter) options+=(--variant segmented --set "segmenter.model=$2") && shift ;;
    --record) recording=(--variant recorded --set "recorder.output=$(realpath -m "$2")") && shift ;;
    --restart) options+=(--restart) ;;
    --set) options+=(--set "$2") && shift ;;
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
[ -n "$scene" ] || [ -e "$dataset" ] || die "$dataset: no such folder or file (wanted is a TUM RGB-D data set or a bag)"
require_build

out=${out:-$repository/out/$(basename "${dataset:-$scene}" .yaml)}
if [ -n "$scene" ]; then
  system=tour source=simulator first=(--set "simulator.scene=$scene")
else
  system=replay source=sensor_replay first=(--set "sensor_replay.dataset=$dataset")
  [ -z "$rate" ] || first+=(--set "sensor_replay.rate=$rate")
  [ ! -d "$dataset/ground_truth" ] || first+=(--set "evaluator.ground_truth_dir=$dataset/ground_truth")
fi
[ -z "$rate" ] || first+=(--variant freerun)
[ -z "$duration" ] || first+=(--set "$source.duration_s=$duration")
run_system "$system" "$command" --out "$out" "${first[@]}" "${options[@]}" "${recording[@]}"
