# shellcheck shell=bash
# Functions that the launch scripts share. Processes are started with a log each and are ended by their ids.

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bin=${LAPIS_BIN:-$repository/build/release/bin}
pids=()
names=()

die() {
  echo "${0##*/}: $*" >&2
  exit 2
}

# Builds release when there is none yet.
require_build() {
  [ -x "$bin/lapis_slam" ] || "$repository/launch_scripts/setup.sh"
}

# start NAME ARGUMENT...: lapis_NAME in the background, its log in $out/logs/NAME.log.
start() {
  local name=$1
  shift
  "$bin/lapis_$name" "$@" >"$out/logs/$name.log" 2>&1 &
  pids+=($!)
  names+=("$name")
}

# wait_ready NAME SECONDS: until the process has printed its ready line.
wait_ready() {
  local name=$1 pid=${pids[-1]} deadline=$((SECONDS + $2))
  until grep -q " $name: ready" "$out/logs/$name.log"; do
    kill -0 "$pid" 2>/dev/null || fail_with "$name" "ended before it was ready"
    [ $SECONDS -lt $deadline ] || fail_with "$name" "not ready within $2 s"
    read -rt 0.05 <> <(:) || true # a short wait without a process of its own
  done
}

# end_process INDEX: asks a process to stop and keeps its exit status.
end_process() {
  local index=$1 status=0
  kill -TERM "${pids[index]}" 2>/dev/null || true
  wait "${pids[index]}" || status=$?
  statuses[index]=$status
}

# Ends everything that still runs; the trap of every script that starts processes.
end_all() {
  local index
  for ((index = ${#pids[@]} - 1; index >= 0; --index)); do
    kill -TERM "${pids[index]}" 2>/dev/null || true
  done
  for index in "${!pids[@]}"; do wait "${pids[index]}" 2>/dev/null || true; done
}

fail_with() {
  echo "${0##*/}: $1: $2; the end of $out/logs/$1.log:" >&2
  tail -n 5 "$out/logs/$1.log" >&2
  exit 1
}
