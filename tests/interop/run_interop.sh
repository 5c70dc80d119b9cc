#!/usr/bin/env bash
# run_interop.sh SOURCE_DIR BIN_DIR WORK_DIR: camera -> slam -> semantic_mapper, watched by a ROS 2 node from npm.
set -euo pipefail

source_dir=$1 bin=$2 work=$3
if ! command -v node >/dev/null || ! command -v npm >/dev/null; then
  echo "SKIPPED: node or npm is missing (Debian: apt install nodejs npm); ROS 2 visibility was NOT tested"
  exit 77
fi
if [ -z "${LAPIS_INTEROP_INSIDE:-}" ]; then
  mkdir -p "$work"
  if [ ! "$work/node_modules/.package-lock.json" -nt "$source_dir/package-lock.json" ]; then # npm writes it at the end
    cp "$source_dir"/{package.json,package-lock.json,.npmrc} "$work"
    (cd "$work" && npm ci --ignore-scripts --no-progress) ||
      { echo "SKIPPED: npm ci failed (is a registry reachable?); ROS 2 visibility was NOT tested"; exit 77; }
  fi
  LAPIS_INTEROP_INSIDE=1 exec "$bin/lapis_in_private_domain" "$0" "$@"
fi

pids=()
stop_all() {
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait
}
trap stop_all EXIT
for program in lapis_slam lapis_semantic_mapper lapis_test_camera; do
  "$bin/$program" >"$work/$program.log" 2>&1 &
  pids+=($!)
done

LAPIS_NODE_MODULES=$work node "$source_dir/observe.mjs" --seconds 60 \
  --listed /tf_static=tf2_msgs/msg/TFMessage \
  --listed /slam/pose_graph=lapis_msgs/msg/PoseGraph \
  --listed /slam/path=nav_msgs/msg/Path \
  --listed /semantic_mapper/points=sensor_msgs/msg/PointCloud2 \
  --listed /semantic_mapper/octomap=octomap_msgs/msg/Octomap \
  --listed /semantic_mapper/occupancy_grid=nav_msgs/msg/OccupancyGrid \
  /slam/odometry=nav_msgs/msg/Odometry \
  /camera/color/image_raw=sensor_msgs/msg/Image \
  /camera/depth/camera_info=sensor_msgs/msg/CameraInfo \
  /tf=tf2_msgs/msg/TFMessage \
  /diagnostics=diagnostic_msgs/msg/DiagnosticArray >"$work/seen.json" ||
  { cat "$work/seen.json" "$work"/lapis_*.log; exit 1; }
node "$source_dir/check_seen.mjs" "$work/seen.json"
