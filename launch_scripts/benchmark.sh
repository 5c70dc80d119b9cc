#!/usr/bin/env bash
# Runs methods in scenes with several seeds, and prints one table.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "$0")/lib.sh"

usage() {
  cat <<'TEXT'
usage: benchmark.sh [--scenes NAME[:S],...] [--methods METHOD,...] [--runs N] [--out DIR] [--world FILE]
                    [--table FILE] [--jobs N] [--then HOW] [--no-preset] [--set KEY=VALUE]...

Runs every scene (bundled names, generated buildings, or files) with every method and seeds 1 to N, and prints a table with all runs, those
that failed included, and their medians. DIR has the same as runs.csv, box plots and the explored share over time as
figures/*.png, and the run folders. A run that DIR has already from the same programs and settings is not repeated, so a
benchmark that was interrupted continues where it was.

  --scenes NAME[:S],...  S: simulated seconds of exploration, 300 unless given (a tour takes the time that it takes);
                         'clinic_[20000-20004]:300' stands for five generated buildings; default:
                         apartment:300,large_building:600
  --methods METHOD,...   as for explore.sh; or tour (default): the robot drives the scene's tour, by replay.sh
  --runs N               seeds per scene and method, default 5
  --out DIR              default: out/benchmark
  --world FILE           as for explore.sh and replay.sh
  --table FILE           instead of runs.csv: each run is a row of this CSV file as soon as it has ended, with all its
                         figures and a key (hash of the programs that take part, of their configuration and settings).
                         What has a row of the same key is not repeated, even when DIR is gone; rows of other keys
                         stay. launch_scripts/benchmark_table.py --rows FILE prints it
  --jobs N               runs that go side by side, default 1; each has a DDS domain of its own, from ROS_DOMAIN_ID
                         (or 0) on
  --then HOW, --no-preset  as for explore.sh; the tour has no use for them
  --set KEY=VALUE        as for explore.sh and replay.sh
Real-time factors are those of a machine that has nothing else to do: the table names the load it found. Exit status:
0 all runs succeeded, 1 a run failed (it is in the table as FAILED, and is repeated the next time), 2 bad options, or
programs that change while they run, 130 and 143 interrupted.
TEXT
}

scenes=apartment:300,large_building:600 methods=tour runs=5 out=$repository/out/benchmark table="" jobs=1 afterwards=none
exploration=() settings=() settings_text="" worlds=() world_text="" world_hashes=()
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --scenes | --methods | --runs | --out | --world | --table | --jobs | --then | --set)
      [ $# -gt 1 ] || die "$1 needs a value (see --help)" ;;&
    --scenes) scenes=$2 && shift ;;
    --methods) methods=$2 && shift ;;
    --runs | --jobs)
      [[ $2 =~ ^[1-9][0-9]*$ ]] || die "$1 $2: wanted is a number"
      if [ "$1" = --runs ]; then runs=$2; else jobs=$2; fi
      shift ;;
    --out) out=$2 && shift ;;
    --world)
      world_hashes+=("$(sha256sum 2>/dev/null <"$2" | cut -c 1-16)") || die "--world $2: no file that can be read"
      worlds+=(--world "$2") world_text+="${world_text:+ }$(basename "$2" .yaml)" && shift ;;
    --table) table=$2 && shift ;;
    --then)
      afterwards=$2 exploration+=(--then "$2") settings_text+="${settings_text:+ }--then $2" && shift ;;
    --no-preset) exploration+=(--no-preset) settings_text+="${settings_text:+ }--no-preset" ;;
    --set) settings+=(--set "$2") settings_text+="${settings_text:+ }$2" && shift ;;
    *) die "unknown option $1 (see --help)" ;;
  esac
  shift
done
first_domain=${ROS_DOMAIN_ID:-0}
[ $((first_domain + jobs)) -le 102 ] || die "--jobs $jobs: DDS domains from $first_domain on, but the last one is 101"
require_build
for method in ${methods//,/ }; do # bad set-up shows before hours of work
  [ "$method" = tour ] || "$bin/lapis_planner" --set "planner.method=$method" --set "planner.then=$afterwards" --check-config >/dev/null || exit 2
done
export ROS_AUTOMATIC_DISCOVERY_RANGE=${ROS_AUTOMATIC_DISCOVERY_RANGE:-LOCALHOST}
lock_folder "$out"
read -r load _ </proc/loadavg
scripts=$repository/launch_scripts finished="" folders=() ids=() running=()
if [ -n "$table" ]; then
  mkdir -p "$(dirname "$table")" || die "--table $table: its folder cannot be made"
  finished=$("$scripts/benchmark_rows.py" finished "$table") || exit 2
fi

# entries_of SCENES: the array `entries`, with a range as clinic_[1-3]:300 written out.
entries_of() {
  local parts part number
  entries=()
  IFS=, read -ra parts <<<"$1"
  for part in "${parts[@]}"; do
    if [[ ! $part =~ ^(.*)\[([0-9]+)-([0-9]+)\](.*)$ ]]; then entries+=("$part") && continue; fi
    [ "${BASH_REMATCH[2]}" -le "${BASH_REMATCH[3]}" ] || die "--scenes $part: nothing is in this range"
    for ((number = 10#${BASH_REMATCH[2]}; number <= 10#${BASH_REMATCH[3]}; ++number)); do
      entries+=("${BASH_REMATCH[1]}$number${BASH_REMATCH[4]}")
    done
  done
}

# benchmark SCENE SECONDS METHOD: all seeds. Only programs that take part are in the identity.
benchmark() {
  local scene=$1 method=$3 name seed folder id identity hashes=("${world_hashes[@]}") command=(explore.sh --method "$3" --duration "$2" "${exploration[@]}")
  local programs=(simulator slam semantic_mapper planner controller evaluator supervisor)
  [ "$method" != tour ] || command=(replay.sh) programs=(simulator slam semantic_mapper evaluator supervisor)
  name=$(basename "$scene" .yaml)
  [ ! -d "$repository/config/methods/$method" ] || hashes+=("$(cat "$repository/config/methods/$method"/* | sha256sum)")
  identity=$(identity_of "$scene" "${command[@]}" "${settings[@]}" "${hashes[@]}")
  for ((seed = 1; seed <= runs; ++seed)); do
    folder=$out/$name/$method/seed_$seed id=$identity/$name/$method/$seed
    [[ "${ids[*]} " != *"/$name/$method/$seed "* ]] || die "two scenes or methods are called $name, $method"
    ids+=("$id")
    if [[ $'\n'$finished$'\n' == *$'\n'"$id"$'\n'* ]]; then continue; fi
    folders+=("$folder")
    beside_others play
  done
}

# play: the run that `benchmark` is at.
play() {
  echo "$name, $method, seed $seed"
  mkdir -p "$(dirname "$folder")"
  play_once "$folder" "$identity" "${command[@]}" --scene "$scene" --seed "$seed" "${settings[@]}" "${worlds[@]}"
  if [ "$identity" != "$(identity_of "$scene" "${command[@]}" "${settings[@]}" "${hashes[@]}")" ]; then
    rm -f "$folder/identity"
    die "$name, $method, seed $seed: programs or configuration have changed during the run; it does not count"
  fi
  [ -z "$table" ] || "$scripts/benchmark_rows.py" add "$table" "$folder" "$id" "$world_text" "$settings_text"
}

# beside_others COMMAND: at once, or as one of several, as soon as there is a place.
beside_others() {
  local place=0
  if [ "$jobs" -eq 1 ]; then
    "$@"
    return
  fi
  [ ${#running[@]} -lt "$jobs" ] || wait_for_one
  while [ -n "${running[place]:-}" ]; do place=$((place + 1)); done
  ROS_DOMAIN_ID=$((first_domain + place)) "$@" &
  running[place]=$!
}

# wait_for_one: of those that run. One that was interrupted, or could not be counted, ends them all.
wait_for_one() {
  local ended place status=0
  wait -n -p ended "${running[@]}" || status=$?
  for place in "${!running[@]}"; do
    if [ "${running[place]}" = "$ended" ]; then unset "running[place]"; fi
  done
  [ $status -eq 0 ] || exit $status
}

if [ "$jobs" -gt 1 ]; then # a place's run ends in order with the shell that waits for it
  trap 'kill "${running[@]}" 2>/dev/null || true' EXIT
  trap 'exit 130' INT
  trap 'exit 143' TERM
fi
entries_of "$scenes"
for entry in "${entries[@]}"; do
  seconds=300
  if [[ $entry =~ :([0-9]+)$ ]]; then seconds=${BASH_REMATCH[1]}; fi
  for method in ${methods//,/ }; do benchmark "${entry%:"$seconds"}" "$seconds" "$method"; done
done
while [ ${#running[@]} -gt 0 ]; do wait_for_one; done
echo "load average before: $load"
[ ${#folders[@]} -eq 0 ] || "$scripts/benchmark_figures.py" "$out" "${folders[@]}"
[ -z "$table" ] || exec "$scripts/benchmark_table.py" --rows "$table" "${ids[@]}"
exec "$scripts/benchmark_table.py" "$out/runs.csv" "${folders[@]}"
