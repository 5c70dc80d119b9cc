# shellcheck shell=bash
# What replay.sh and explore.sh share: a run of the chain of processes, from its options to its run folder.
# shellcheck source-path=SCRIPTDIR
source "$(dirname "${BASH_SOURCE[0]}")/lib.sh"

shopt -s extglob

# The script fills these before it calls run_chain, and `out` of lib.sh.
components=() # in the order of their start; the source of frames is the last one
play=() # arguments of the source
settings=() # component, KEY=VALUE, component, KEY=VALUE, ...
robots=("$repository/config/robot.yaml") # files of the robot's description
subject="" # line of the manifest that says what is played
declare -A resumed=() # maps of earlier runs that are gone on with, by component
shown="" view=cat # component whose log is shown while the run goes on (default: the source), and how
max_restarts=0 # of each component that dies
commit="" # of the repository when the run began
declare -A restarts=() # by component, so far
command_line="$*"

source_of_frames() { echo "${components[-1]}"; }

is_in_run() { [[ " ${components[*]} " == *" $1 "* ]]; }

knows_robot() { [ "$1" != slam ] && [ "$1" != sensor_replay ] && [ "$1" != evaluator ]; }

# give COMPONENT KEY=VALUE: when it is in this run.
give() { ! is_in_run "$1" || settings+=("$1" "$2"); }

# route KEY=VALUE: to the components that it concerns.
route() {
  local name=${1%%.*} other
  [[ $1 != @(slam|semantic_mapper).resume_from=* ]] || resumed[$name]=${1#*=}
  case $1 in
    dds.*=*) for other in "${components[@]}"; do give "$other" "$1"; done ;;
    robot.*=*) for other in "${components[@]}"; do ! knows_robot "$other" || give "$other" "$1"; done ;;
    lockstep.*=*) give "$(source_of_frames)" "$1" ;;
    @(slam|semantic_mapper|planner|controller|evaluator|sensor_replay|simulator).*=*)
      is_in_run "$name" || die "--set $1: no $name in this run"
      give "$name" "$1" ;;
    *) die "--set $1: unknown key; wanted is KEY=VALUE, KEY begins with dds., lockstep., robot., ${components[*]/%/.}" ;;
  esac
}

# is_resumed FILE: whether the run goes on with this map.
is_resumed() {
  local map
  for map in "${resumed[@]}"; do
    if [ "$1" -ef "$map" ]; then return 0; fi
  done
  return 1
}

# make_run_folder: $out, without results of an earlier run, but for the maps that are gone on with.
make_run_folder() {
  local file
  mkdir -p "$out/logs" || die "$out cannot be made a run folder; choose another with --out DIR"
  (
    cd "$out" || exit
    rm -f identity manifest.yaml simulation.yaml metrics.json timeline.csv decisions?(.+([0-9])).csv \
      trajectory_{estimate,ground_truth}.txt reference_map.lapis \
      {keyframes,pose_graph,map}?(.+([0-9])).{txt,g2o,ot,ply} \
      ground_truth/{mesh,flood,ideal}.lapis ground_truth/{classes,rooms}.json ground_truth/navmap.{png,yaml} \
      figures/{map,trajectory,pose_graph,coverage,errors,class_iou,decision}.png \
      logs/{slam,semantic_mapper,planner,controller,evaluator,sensor_replay,simulator}.log
  )
  for file in "$out"/{slam,map}?(.+([0-9])).lapis; do
    is_resumed "$file" || rm -f "$file"
  done
}

# collect_arguments NAME: sets `arguments` to the command line of a component.
collect_arguments() {
  local i robot
  if [ "$1" = "$(source_of_frames)" ]; then
    arguments=("${play[@]}")
  elif [ "$1" = controller ]; then # has no files
    arguments=()
  else
    arguments=(--set "$1.output_dir=$out")
  fi
  if knows_robot "$1"; then for robot in "${robots[@]}"; do arguments+=(--config "$robot"); done; fi
  for ((i = 0; i < ${#settings[@]}; i += 2)); do
    [ "${settings[i]}" != "$1" ] || arguments+=(--set "${settings[i + 1]}")
  done
}

write_manifest() {
  local name
  {
    printf 'version: "%s"\ncommit: "%s"\ncommand: |-\n  %s %s\n%s\nexit_status:\n' "$("$bin/lapis_slam" --version)" \
      "$commit" "${0##*/}" "$command_line" "$subject"
    for name in "${names[@]}"; do echo "  $name: ${statuses[$name]:-null}"; done
    if [ "$max_restarts" -gt 0 ]; then
      echo "restarts:"
      for name in "${names[@]}"; do echo "  $name: ${restarts[$name]:-0}"; done
    fi
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
  echo "${0##*/}: interrupted by $1; what was played is in $out" >&2
  exit "$2"
}

# start_component NAME ARGUMENT...: the arguments are added to its own.
start_component() {
  collect_arguments "$1"
  if [ "$1" = "${shown:-$(source_of_frames)}" ]; then
    start_shown "$view" "$1" "${arguments[@]}" "${@:2}"
  else
    start "$1" "${arguments[@]}" "${@:2}"
  fi
}

# allow_restarts: what --restart does; lock-step waits for who comes again.
allow_restarts() {
  max_restarts=3
  give "$(source_of_frames)" lockstep.silent_participant=wait
}

# restart NAME: starts a component that has died anew. False when that must not be: it has been often enough, its
# set-up is bad, or it is the source of frames, whose state is the run.
restart() {
  local name=$1 number=$((${restarts[$1]:-0} + 1)) more=()
  [ "$number" -le "$max_restarts" ] && [ "$name" != "$(source_of_frames)" ] || return 1
  end_process "$name"
  [ "${statuses[$name]}" != 2 ] || return 1
  [ "$name" != "$shown" ] || wait "$viewer" || true
  restarts[$name]=$number
  echo "${0##*/}: $name ended with status ${statuses[$name]} and is started again ($number of $max_restarts)" |
    tee -a "$out/logs/$name.log" >&2
  unset "statuses[$name]"
  if [ "$name" = semantic_mapper ] && [ -f "$out/map.lapis" ]; then
    more=(--set "semantic_mapper.resume_from=$out/map.lapis" --set semantic_mapper.resume_any_session=false)
  fi
  start_component "$name" "${more[@]}"
}

# run_chain: starts the components and waits for the end of the source, which is the first one to end unless something
# went wrong; then ends the others, writes the manifest and says how it went.
run_chain() {
  local source name early
  source=$(source_of_frames)
  commit=$(describe_commit)
  trap end_all EXIT
  trap 'interrupted SIGINT 130' INT
  trap 'interrupted SIGTERM 143' TERM
  for name in "${components[@]}"; do
    start_component "$name"
    [ "$name" = "$source" ] || wait_ready "$name" 20
  done
  wait_first
  while restart "$first"; do wait_first; done
  early=$first
  end_all
  write_manifest
  [ "$early" = "$source" ] || fail_with "$early" "ended early with status ${statuses[$early]}"
  print_metrics
  for name in "$source" "${components[@]}"; do
    [ "${statuses[$name]}" = 0 ] || fail_with "$name" "failed with status ${statuses[$name]}" "${statuses[$name]}"
  done
  [ -f "$out/metrics.json" ] || fail_with slam "no frame came; the reason may be here or in the other logs"
  echo "run folder: $out"
}
