#!/usr/bin/env bash
# Installs what is missing, builds the release preset and runs the tests, tier by tier.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
tiers=(unit contract integration interop)

usage() {
  cat <<TEXT
usage: launch_scripts/test.sh [--tier unit|contract|integration|interop|long|faults]
  --tier NAME  only this tier; default: all of them but long and faults
  long: tests that take over a minute, the benchmarks' build, 25 generated buildings, unit and contract tests with
  AddressSanitizer and UndefinedBehaviorSanitizer, and clang-tidy on what has changed since it passed last; docs/long_tests.md gets the results
  faults: what Lapis promises when something fails, by cases of the other tiers (tests/faults); docs/reliability.md gets the results
Environment: LAPIS_TEST_DATA, the folder of recorded test data (default ../shared/data beside the repository, when it
exists); tests that need it are skipped without it.
TEXT
}
while [[ $# -gt 0 ]]; do
  case "$1" in
    --tier)
      [[ " ${tiers[*]} long faults " == *" ${2:-} "* && -n "${2:-}" ]] || { usage >&2; exit 2; }
      tiers=("$2")
      shift 2 ;;
    --help | -h) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
  esac
done

if [[ -n "${LAPIS_TEST_DATA:-}" ]]; then
  [[ -d "$LAPIS_TEST_DATA" ]] || { echo "test.sh: LAPIS_TEST_DATA=$LAPIS_TEST_DATA: no such folder" >&2; exit 2; }
  LAPIS_TEST_DATA="$(cd "$LAPIS_TEST_DATA" && pwd)" # tests run in other folders
fi
"$root/launch_scripts/setup.sh" --dev
cd "$root"
export ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST
if [[ -z "${LAPIS_TEST_DATA:-}" && -d ../shared/data ]]; then
  LAPIS_TEST_DATA="$(cd ../shared/data && pwd)"
  export LAPIS_TEST_DATA
fi
echo "test data: ${LAPIS_TEST_DATA:-none, tests that need it are skipped}"

build=build/release failed=() summaries=() reasons="" rows=""

# reasons_of_skips: one line for each test that the last ctest skipped. GoogleTest's own skips count as passed for ctest.
reasons_of_skips() {
  awk '/: Skipped$/ && getline > 0 { print } sub(/^SKIPPED: /, "") { print }' "$build/Testing/Temporary/LastTest.log" |
    sed 's/ at .*; set \([A-Z_]*\).*/, set \1/; s/ *[;(].*//'
}

run_tier() {
  local log="$build/Testing/$1.log"
  echo "== $1"
  ctest --test-dir "$build" --output-on-failure --no-tests=error -L "^$1\$" --parallel "$(nproc)" -O "$log" \
    --output-junit "$root/$log.xml" --test-output-size-passed 1000000 || failed+=("$1")
  summaries+=("$1: $(grep 'tests passed' "$log" || echo 'no tests')")
  reasons+="$(reasons_of_skips)"$'\n'
  if [[ "$1" == long ]]; then
    rows="$(sed -n 's/^.*Test *#[0-9]*: \([^ ]*\) [. *]*\([A-Za-z ]*[a-z]\) *\([0-9.]*\) sec.*/| \1 | \3 | \2 |/p' "$log")"
  fi
}

# check NAME COMMAND...: of the long tier, no test of ctest.
check() {
  local name="$1" result=Passed began=$SECONDS status
  shift
  echo "== $name"
  set +e
  (set -e; "$@")
  status=$?
  set -e
  [[ $status -eq 0 ]] || { result=Failed && failed+=("$name"); }
  rows+=$'\n'"| $name | $((SECONDS - began)) | $result |"
}

test_sanitized() {
  local status=0
  export UBSAN_OPTIONS=print_stacktrace=1
  cmake --preset asan
  cmake --build --preset asan
  ctest --preset asan --label-regex '^unit$' --no-tests=error --parallel "$(nproc)" || status=1
  ctest --preset asan --label-regex '^contract$' --no-tests=error || status=1
  return "$status"
}

# Five of each kind that the unit test does not draw, with the check of features, which takes most of the time.
check_buildings() {
  rm -f "$build/Testing/buildings.csv"
  launch_scripts/buildings.py "$build/Testing/buildings.csv" --first 101 --count 5
}

# Recordings as worse cameras would give them: calibrations as they are given, and as slam estimates them.
perturb_recordings() {
  local kinds="none, depth late, focal length +3 %, focal length -3 %, depth not registered" status=0
  [[ -n "${LAPIS_TEST_DATA:-}" ]] || { echo "SKIPPED: perturbed recordings; set LAPIS_TEST_DATA"; return 0; }
  launch_scripts/perturb.sh "$LAPIS_TEST_DATA"/rgbd/*/ | tee docs/results/perturbations.md || status=1
  launch_scripts/perturb.sh "$LAPIS_TEST_DATA"/rgbd/*/ --kinds "$kinds" --set slam.depth_calibration=estimate |
    tee docs/results/perturbations_estimated.md || status=1
  return "$status"
}

# check_changed_files: those since the last run in which they passed.
check_changed_files() { .ci/tidy ${tidied:+--since "$tidied"}; }

write_results() {
  local commit
  commit="$(git rev-parse --short HEAD)"
  [[ " ${failed[*]} " == *clang-tidy* ]] || tidied="$commit"
  cat >docs/long_tests.md <<TEXT
# Long tests

What takes over a minute is not part of \`.ci/run\`. \`launch_scripts/test.sh --tier long\` runs it and writes this page.

Last run: commit $commit, $(date -u +%Y-%m-%d), $(nproc) cores.

| what | seconds | result |
| --- | --- | --- |
$rows

clang-tidy has passed up to commit $tidied.
TEXT
}

for tier in "${tiers[@]}"; do run_tier "$tier"; done
if [[ "${tiers[*]}" == long ]]; then
  check "benchmarks build" cmake --build --preset release --target benchmarks
  check "generated buildings" check_buildings
  check "perturbed recordings" perturb_recordings
  check "unit and contract tests with ASan and UBSan" test_sanitized
  tidied="$(sed -n 's/^clang-tidy has passed up to commit \([0-9a-f]*\)\.$/\1/p' docs/long_tests.md)"
  check "clang-tidy on files that have changed since ${tidied:-the last commit}" check_changed_files
  write_results
fi
if [[ "${tiers[*]}" == faults ]]; then
  launch_scripts/reliability_table.py tests/faults/faults.json "$build/Testing/faults.log.xml" "$(git rev-parse --short HEAD)" \
    >"$build/Testing/reliability.md"
  cp "$build/Testing/reliability.md" docs/reliability.md
fi
echo
printf '%s\n' "${summaries[@]}"
reasons="$(sed '/^$/d' <<<"$reasons" | sort | uniq -c | sed 's/^ *\([0-9]*\) /\1 x /' | paste -sd ';' | sed 's/;/; /g')"
echo "skipped: ${reasons:-none}"
if [[ ${#failed[@]} -gt 0 ]]; then echo "FAILED: ${failed[*]}"; exit 1; fi
