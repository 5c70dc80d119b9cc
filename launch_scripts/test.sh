#!/usr/bin/env bash
# Installs what is missing, builds the release preset and runs the tests, tier by tier.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
tiers=(unit contract integration interop)

usage() {
  cat <<TEXT
usage: launch_scripts/test.sh [--tier unit|contract|integration|interop]
  --tier NAME  only this tier; default: all of them
Environment: LAPIS_TEST_DATA, the folder of recorded test data (default ../shared/data beside the repository, when it
exists); tests that need it are skipped without it.
TEXT
}
while [[ $# -gt 0 ]]; do
  case "$1" in
    --tier)
      [[ " ${tiers[*]} " == *" ${2:-} "* && -n "${2:-}" ]] || { usage >&2; exit 2; }
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
"$root/launch_scripts/setup.sh"
cd "$root"
export ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST
if [[ -z "${LAPIS_TEST_DATA:-}" && -d ../shared/data ]]; then
  LAPIS_TEST_DATA="$(cd ../shared/data && pwd)"
  export LAPIS_TEST_DATA
fi
echo "test data: ${LAPIS_TEST_DATA:-none, tests that need it are skipped}"

failed=() skipped="" log=build/release/Testing/Temporary/LastTest.log
for tier in "${tiers[@]}"; do
  echo "== $tier"
  ctest --preset release -L "^$tier\$" --parallel "$(nproc)" || failed+=("$tier")
  # GoogleTest's own skips count as passed for ctest; its log has them.
  skipped+="$(grep -Eh '^\[  SKIPPED \] [^ ]+ \(|^SKIPPED( \[|:)|\*\*\*Skipped' "$log" || true)"$'\n'
done
skipped="$(sort -u <<<"$skipped" | sed '/^$/d')"
if [[ -n "$skipped" ]]; then printf '== skipped (%s)\n%s\n' "$(wc -l <<<"$skipped")" "$skipped"; fi
if [[ ${#failed[@]} -gt 0 ]]; then echo "FAILED: ${failed[*]}"; exit 1; fi
echo "passed: ${tiers[*]}"
