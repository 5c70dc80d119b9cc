#!/usr/bin/env bash
# CPU seconds of a build from nothing, without a compiler cache: by folder, and the dearest files.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"

usage() {
  cat <<TEXT
usage: launch_scripts/build_report.sh [--preset NAME] [--target NAME]... [--folder DIR] [--keep]
  --preset NAME  of CMakePresets.json; default release
  --target NAME  what to build, again for more; default: the programs (lapis_*), no tests; "all" for everything
  --folder DIR   where it is built, emptied first; default build/report
  --keep         leave the folder there; default: only cpu_seconds.tsv stays
Builds in that folder without a compiler cache, and prints the CPU seconds (user and system) that the compiler and the linker
took, by folder, and the 20 dearest files. A busy machine takes more CPU seconds for the same work: compare only what was
measured side by side.
TEXT
}
preset=release targets=() folder="$root/build/report" keep=no
while [[ $# -gt 0 ]]; do
  case "$1" in
    --preset | --target | --folder)
      [[ -n "${2:-}" ]] || { usage >&2; exit 2; }
      case "$1" in
        --preset) preset="$2" ;;
        --target) targets+=("$2") ;;
        --folder) folder="$2" ;;
      esac
      shift 2 ;;
    --keep) keep=yes; shift ;;
    --help | -h) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
  esac
done
if [[ ${#targets[@]} -eq 0 ]]; then
  targets=(command_line simulator sensor_replay recorder slam segmenter semantic_mapper planner controller evaluator supervisor topics)
fi
if [[ -e "$folder" && ! -e "$folder/cpu_seconds.tsv" && -n "$(ls -A "$folder" 2>/dev/null)" ]]; then
  echo "build_report.sh: $folder is there and no report of before: choose another --folder" >&2
  exit 2
fi
rm -rf "$folder"
mkdir -p "$folder"
folder="$(cd "$folder" && pwd)"
times="$folder/cpu_seconds.tsv"
launcher="python3;$root/launch_scripts/cpu_seconds.py;run;$times"
cd "$root"
: >"$times"
cmake --preset "$preset" -B "$folder" "-DCMAKE_CXX_COMPILER_LAUNCHER=$launcher" "-DCMAKE_CXX_LINKER_LAUNCHER=$launcher" \
  >"$folder/configure.log" || { tail -n 20 "$folder/configure.log" >&2; exit 2; }
: >"$times" # what configuring compiled is not counted
python3 launch_scripts/cpu_seconds.py run "$folder/whole.tsv" cmake --build "$folder" --target "${targets[@]}"
python3 launch_scripts/cpu_seconds.py table "$times" "$folder" "$folder/whole.tsv"
if [[ $keep == no ]]; then find "$folder" -mindepth 1 -maxdepth 1 ! -name cpu_seconds.tsv -exec rm -rf {} +; fi
