#!/usr/bin/env bash
# Plays the same tours and data sets to variants of the configuration and prints what they reach side by side.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "$0")/lib.sh"

usage() {
  cat <<'TEXT'
usage: compare.sh --variant 'NAME [KEY=VALUE]...' --variant '...' [--scenes NAME,...] [--data DIR]... [--runs N]
                  [--first N] [--recorded] [--out DIR]

Plays every scene (bundled names or files) with N seeds, and every data set once, to each variant, and prints a table:
maps and trajectories of the variants, and the differences to the first one with 95 % bootstrap intervals.
A run that DIR has already from the same programs and settings is not repeated.

  --variant TEXT     a name and its settings, as for replay.sh
  --scenes NAME,...  default: none
  --data DIR         data set in the layout of the TUM RGB-D benchmark
  --runs N           seeds per scene, default 5;  --first N  the first of them, default 1
  --recorded         each tour is rendered once (up to 5 GB) and played to all variants, without wheel odometry
  --out DIR          default: out/compare

Example: launch_scripts/compare.sh --scenes apartment --variant on --variant 'off semantic_mapper.re_anchor=false'
docs/scenes.md has one that shows what forced revisits of old places are worth.
Exit status: 0 all runs succeeded, 1 a run failed (the table has - for it, and it is repeated the next time), 2 bad
set-up, 130 and 143 interrupted.
TEXT
}

scenes="" runs=5 first=1 is_recorded="" out=$repository/out/compare data=() variants=()
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) usage && exit 0 ;;
    --variant | --scenes | --data | --runs | --first | --out) [ $# -gt 1 ] || die "$1 needs a value (see --help)" ;;&
    --variant) variants+=("$2") && shift ;;
    --scenes) scenes=$2 && shift ;;
    --data) data+=("$2") && shift ;;
    --runs | --first)
      [[ $2 =~ ^[1-9][0-9]*$ ]] || die "$1 $2: wanted is a number of seeds"
      if [ "$1" = --runs ]; then runs=$2; else first=$2; fi
      shift ;;
    --recorded) is_recorded=yes ;;
    --out) out=$2 && shift ;;
    *) die "unknown option $1 (see --help)" ;;
  esac
  shift
done
[ ${#variants[@]} -ge 2 ] || die "two variants or more are needed (see --help)"
[ -n "$scenes" ] || [ ${#data[@]} -gt 0 ] || die "give --scenes or --data (see --help)"
names=()
for variant in "${variants[@]}"; do
  read -r name _ <<<"$variant"
  [[ $name =~ ^[A-Za-z0-9_.-]+$ ]] || die "--variant '$variant': wanted is a name, then KEY=VALUE"
  [[ " ${names[*]} " != *" $name "* ]] || die "two variants are called $name"
  names+=("$name")
done
for folder in "${data[@]}"; do [ -d "$folder" ] || die "--data $folder: no such folder"; done
require_build
lock_folder "$out"
export ROS_AUTOMATIC_DISCOVERY_RANGE=${ROS_AUTOMATIC_DISCOVERY_RANGE:-LOCALHOST}

# play TITLE WHAT ARGUMENT...: to every variant. WHAT is the scene or data set on which the results depend.
play() {
  local title=$1 what=$2 variant name words setting settings identity
  shift 2
  [[ " ${titles[*]} " != *" $title "* ]] || die "two scenes or data sets are called $title"
  titles+=("$title")
  for variant in "${variants[@]}"; do
    read -ra words <<<"$variant"
    name=${words[0]} settings=()
    played+=("$name=$out/$name/$title")
    for setting in "${words[@]:1}"; do settings+=(--set "$setting"); done
    identity=$(identity_of "$what" "$@" "${settings[@]}")
    if has_run "$out/$name/$title" "$identity"; then continue; fi
    echo "$title, $name"
    mkdir -p "$out/$name"
    render "$@"
    play_once "$out/$name/$title" "$identity" replay.sh "$@" "${settings[@]}"
  done
}

# render ARGUMENT...: what is to be played, when it is a tour that is not there yet.
render() {
  if [ "$1" != "$tour" ] || [ -d "$tour" ]; then return; fi
  mkdir -p "$out/tours"
  setpriv --pdeathsig TERM "$bin/lapis_simulator" "$scene" --seed "$seed" --export-tum "$tour.part" >"$tour.log"
  mv "$tour.part" "$tour"
}

tour="" titles=() played=()
IFS=, read -ra entries <<<"$scenes"
for scene in "${entries[@]}"; do
  for ((seed = first; seed < first + runs; ++seed)); do
    title=$(basename "$scene" .yaml)_$seed
    if [ -z "$is_recorded" ]; then
      play "$title" "$scene" --scene "$scene" --seed "$seed"
    else
      tour=$out/tours/$title
      rm -rf "$tour" "$tour.part"
      play "$title" "$scene" "$tour"
      rm -rf "$tour"
    fi
  done
done
for folder in "${data[@]}"; do play "$(basename "$folder")" "$folder" "$folder"; done
exec "$repository/launch_scripts/compare_table.py" "${played[@]}"
