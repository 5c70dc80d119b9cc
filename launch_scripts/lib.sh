# shellcheck shell=bash
# Functions that the launch scripts share.

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bin=${LAPIS_BIN:-$repository/build/release/bin}
programs=(simulator sensor_replay recorder slam segmenter semantic_mapper planner controller evaluator supervisor)

# die TEXT: bad set-up.
die() {
  echo "${0##*/}: $*" >&2
  exit 2
}

# Builds release when there is none yet and LAPIS_BIN names no other programs; a build that lacks a program is bad set-up.
require_build() {
  local program
  [ -n "${LAPIS_BIN:-}" ] || [ -x "$bin/lapis_slam" ] || "$repository/launch_scripts/setup.sh"
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
    cat "${programs[@]/#/$bin/lapis_}" "$repository"/config/{robot.yaml,run.yaml,systems/*,scenes/*,labels/*}
    if [ -f "$1" ]; then cat "$1"; fi
    ls -l /usr/share/sweethome3d/furniture 2>/dev/null || echo "parametric furniture"
    echo "${@:2}"
  } | sha256sum | cut -c 1-16
}

# lock_folder FOLDER: makes it, for this script alone until it ends.
lock_folder() {
  mkdir -p "$1" || die "$1 cannot be made a folder; choose another with --out DIR"
  exec {folder_lock}<"$1"
  flock --nonblock "$folder_lock" || die "$1 is in use by another benchmark.sh or compare.sh; choose another with --out DIR"
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
  case $status in 130 | 143) exit $status ;; esac
  if [ $status -eq 0 ]; then echo "$identity" >"$folder/identity"; else tail -n 3 "$folder.log" >&2; fi
}

# run_system NAME COMMAND ARGUMENT...: config/systems/NAME.yaml by the supervisor, which takes this shell's place. COMMAND
# is what the user called.
run_system() {
  local system=$1 command=$2 commit
  shift 2
  commit=$(describe_commit)
  exec "$bin/lapis_supervisor" "$repository/config/systems/$system.yaml" --command "$command" --programs "$bin" \
    --fact "commit=$commit" "$@"
}
