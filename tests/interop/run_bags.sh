#!/usr/bin/env bash
# run_bags.sh SOURCE_DIR BIN_DIR WORK_DIR: bags of lapis_recorder, whole and killed, read by npm packages; needs what
# run_interop.sh has installed in WORK_DIR.
set -euo pipefail

source_dir=$1 bin=$2 work=$3
if [ ! -d "$work/node_modules/@mcap/core" ]; then
  echo "SKIPPED: npm packages are missing (npm_ros2_node says why); bags were NOT read by others"
  exit 77
fi
if [ -z "${LAPIS_INTEROP_INSIDE:-}" ]; then
  LAPIS_INTEROP_INSIDE=1 exec "$bin/lapis_in_private_domain" "$0" "$@"
fi

pids=()
stop_all() {
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait
}
trap stop_all EXIT
rm -rf "$work/bags"
mkdir -p "$work/bags"
"$bin/lapis_test_camera" >"$work/bags/camera.log" 2>&1 &
pids+=($!)

# record NAME SIGNAL OPTION...: records until ten images are in the bag, then ends the recorder by SIGNAL.
record() {
  local name=$1 signal=$2 status=0
  shift 2
  mkdir "$work/bags/$name"
  "$bin/lapis_recorder" "$work/bags/$name" "$@" >"$work/bags/$name.log" 2>&1 &
  local recorder=$!
  pids+=("$recorder")
  node "$source_dir/wait_for_bag.mjs" "$work/bags/$name" /camera/color/image_raw 10 || { cat "$work/bags/$name.log"; exit 1; }
  kill -"$signal" "$recorder"
  wait "$recorder" || status=$?
  [ "$signal" = KILL ] || [ $status -eq 0 ] || { cat "$work/bags/$name.log"; exit 1; }
}

record mcap INT --set recorder.split_mb=4
record sqlite3 INT --storage sqlite3
record killed KILL
for name in mcap sqlite3; do
  LAPIS_NODE_MODULES=$work node "$source_dir/check_bag.mjs" "$work/bags/$name" | tee "$work/bags/$name.json"
  grep -q '"/camera/color/image_raw"' "$work/bags/$name.json"
done
LAPIS_NODE_MODULES=$work node "$source_dir/check_bag.mjs" "$work/bags/killed" --killed | grep '"/camera/color/image_raw"'
