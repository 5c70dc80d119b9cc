#!/usr/bin/env bash
# Runs every fuzzer and prints a table. Inputs that crash stay in build/fuzz/crashes.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
build="$root/build/fuzz"
fuzzers=(bag catalog frames gltf hm3d house image map message obj octree ply pose_graph replica scene situation slam text trajectory zip)

if [[ "${1:-}" == --help || "${1:-}" == -h ]]; then
  echo "usage: tests/fuzz/run.sh [SECONDS [NAME...]]   seconds for each fuzzer (600); names of: ${fuzzers[*]}"
  exit 0
fi
seconds="${1:-600}"
shift || true
if [[ $# -gt 0 ]]; then fuzzers=("$@"); fi
command -v clang++ >/dev/null || { echo "run.sh: clang is missing: launch_scripts/setup.sh --dev installs it" >&2; exit 2; }

cd "$root"
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz
"$build/bin/lapis_fuzz_seeds" "$build/seeds"
mkdir -p "$build/crashes"
export UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1

# Number after the last "cov:" or "stat::NAME:" of a log.
last_number() { grep -oE "$1 +[0-9]+" "$2" | tail -n 1 | grep -oE '[0-9]+$' || echo 0; }

failed=0
printf '%-10s %12s %10s %8s\n' fuzzer executions coverage crashes
for name in "${fuzzers[@]}"; do
  corpus="$build/corpus/$name" log="$build/$name.log"
  mkdir -p "$corpus"
  crashes=0
  # A list in a message takes no more memory than its bytes allow: 16 kB of them, as many elements of at most 1 kB.
  limit=()
  if [[ $name == message ]]; then limit=(-malloc_limit_mb=32); fi
  "$build/bin/${name}_fuzz" "$corpus" "$build/seeds/$name" -max_total_time="$seconds" -max_len=16384 -timeout=20 \
    -rss_limit_mb=3000 "${limit[@]}" -print_final_stats=1 -artifact_prefix="$build/crashes/$name-" >"$log" 2>&1 || crashes=1
  printf '%-10s %12s %10s %8s\n' "$name" "$(last_number 'stat::number_of_executed_units:' "$log")" \
    "$(last_number 'cov:' "$log")" "$crashes"
  if [[ $crashes != 0 ]]; then
    failed=1
    grep -E '^SUMMARY|runtime error|Test unit written' "$log" || true
  fi
done
exit "$failed"
