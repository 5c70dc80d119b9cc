# shellcheck shell=bash
# Functions that the launch scripts share. Processes are started with a log each and are ended by their ids.

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bin=${LAPIS_BIN:-$repository/build/release/bin}
programs=(simulator sensor_replay slam semantic_mapper planner controller evaluator)
out="" # run folder, set by the script
names=() # of the processes, in the order of their start
declare -A pids=() statuses=() # by name; statuses of those that have ended
viewer="" # process that shows a log

# die TEXT: bad set-up.
die() {
  echo "${0##*/}: $*" >&2
  exit 2
}

# Builds release when there is none yet; a build that lacks a program is bad set-up.
require_build() {
  local program
  [ -x "$bin/lapis_slam" ] || "$repository/launch_scripts/setup.sh"
  for program in "${programs[@]}"; do
    [ -x "$bin/lapis_$program" ] || die "no program $bin/lapis_$program; launch_scripts/setup.sh builds build/release/bin"
  done
}

# describe_commit: of the repository; with "-not-built" when a source is newer than every program.
describe_commit() {
  local program newest=$bin/lapis_slam commit source
  commit=$(git -C "$repository" describe --always --dirty 2>/dev/null) || return 0
  for program in "$bin"/lapis_*; do
    if [ "$program" -nt "$newest" ]; then newest=$program; fi
  done
  source=$(find "$repository"/{common,components,idl} -type f \( -name '*.cpp' -o -name '*.hpp' -o -name '*.idl' \) -newer "$newest" -print -quit)
  if [ -n "$source" ]; then
    echo "${0##*/}: $source is newer than the programs in $bin: build them first to run them" >&2
    commit+=-not-built
  fi
  echo "$commit"
}

# identity_of SCENE WORD...: what the results of a scene depend on; other programs, settings or scenes give another.
identity_of() {
  {
    cat "${programs[@]/#/$bin/lapis_}" "$repository"/config/{robot.yaml,scenes/*,labels/*}
    if [ -f "$1" ]; then cat "$1"; fi
    ls -l /usr/share/sweethome3d/furniture 2>/dev/null || echo "parametric furniture"
    echo "${@:2}"
  } | sha256sum | cut -c 1-16
}

# has_run FOLDER IDENTITY: whether FOLDER has a good run of that identity.
has_run() {
  [ "$(cat "$1/identity" 2>/dev/null)" = "$2" ]
}

# play_once FOLDER IDENTITY SCRIPT ARGUMENT...: replay.sh or explore.sh into FOLDER, unless it has that run already. An
# interruption ends the script; a failure shows the end of its log and leaves no identity.
play_once() {
  local folder=$1 identity=$2 script=$3 status=0
  shift 3
  if has_run "$folder" "$identity"; then return 0; fi
  rm -f "$folder/identity" "$folder/metrics.json"
  setpriv --pdeathsig TERM "$repository/launch_scripts/$script" "$@" --out "$folder" >"$folder.log" 2>&1 || status=$?
  [ $status -lt 128 ] || exit $status
  if [ $status -eq 0 ]; then echo "$identity" >"$folder/identity"; else tail -n 3 "$folder.log" >&2; fi
}

# start NAME ARGUMENT...: lapis_NAME in the background, its log at the end of $out/logs/NAME.log. It ends with this
# shell, however that ends.
start() {
  launch "$@" >>"$out/logs/$1.log" 2>&1
}

# start_shown VIEW NAME ARGUMENT...: the same, and VIEW, a command, shows of the log on its input what is to be seen.
start_shown() {
  local view=$1 sink
  shift
  exec {sink}> >(trap '' INT TERM && tee -a "$out/logs/$1.log" | "$view")
  viewer=$!
  launch "$@" >&"$sink" 2>&1
  exec {sink}>&-
}

# show_progress: a view of the evaluator's log: how far the run is. On a terminal each line replaces the one before.
show_progress() {
  local line text="" columns
  exec 3>&1
  while IFS= read -r line; do
    [[ $line == *" evaluator: progress: "* ]] || continue
    text=${line#* progress: }
    if [ ! -t 1 ]; then echo "$text" && continue; fi
    read -r _ columns < <(stty size <&3)
    printf '\r\e[K%.*s' $((columns - 1)) "$text"
  done
  [ -z "$text" ] || [ ! -t 1 ] || echo
}

# In a session of its own: Ctrl-C on the terminal is the launcher's, who ends its processes in their order.
launch() {
  local name=$1
  shift
  setsid setpriv --pdeathsig TERM "$bin/lapis_$name" "$@" &
  pids[$name]=$!
  [[ " ${names[*]} " == *" $name "* ]] || names+=("$name")
}

# wait_ready NAME SECONDS: until the process has printed its ready line.
wait_ready() {
  local name=$1 pid=${pids[$1]} deadline=$((SECONDS + $2)) status=0
  until grep -qs " $name: ready" "$out/logs/$name.log"; do
    if ! kill -0 "$pid" 2>/dev/null; then
      wait "$pid" || status=$?
      fail_with "$name" "ended before it was ready, with status $status" "$status"
    fi
    [ $SECONDS -lt $deadline ] || fail_with "$name" "not ready within $2 s"
    sleep 0.05
  done
}

# wait_first: until one of the processes has ended; sets `first` to its name. Asked again and again, because `wait -n`
# of bash 5.2 waits for ever when the process ends while bash reaps another child, and a trap that exits out of
# `read -t` crashes.
wait_first() {
  while true; do
    for first in "${names[@]}"; do
      kill -0 "${pids[$first]}" 2>/dev/null || return 0
    done
    sleep 0.1
  done
}

# end_process NAME: asks a process to stop and keeps its exit status.
end_process() {
  local status=0
  kill -TERM "${pids[$1]}" 2>/dev/null || true
  wait "${pids[$1]}" || status=$?
  statuses[$1]=$status
}

# Ends everything that still runs; the trap of every script that starts processes. The source of frames, which is started
# last, first; then in the order of the starts: who collects what others write at their end was started after them.
end_all() {
  local name
  for name in "${names[@]: -1}" "${names[@]}"; do
    [ -n "${statuses[$name]:-}" ] || end_process "$name"
  done
  [ -z "$viewer" ] || wait "$viewer" 2>/dev/null || true # now the log is complete
}

# fail_with NAME TEXT [STATUS]: shows the end of the process's log. Bad set-up (2) stays that, the rest is a failure.
fail_with() {
  echo "${0##*/}: $1: $2; the end of $out/logs/$1.log:" >&2
  tail -n 5 "$out/logs/$1.log" >&2
  if [ "${3:-1}" = 2 ]; then exit 2; fi
  exit 1
}
