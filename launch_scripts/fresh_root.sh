#!/usr/bin/env bash
# Lapis in a Debian root that has nothing yet: what a newcomer waits for, or whether the tests pass there.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"

usage() {
  cat <<TEXT
usage: launch_scripts/fresh_root.sh FOLDER --release bookworm|trixie [--test] [--mirror URL]
  FOLDER         the Debian root; made by debootstrap when it does not exist, used again otherwise
  --release NAME Debian 12 (bookworm, Fast DDS 2.9) or 13 (trixie, Fast DDS 3.1)
  --test         build everything and run unit and contract tests; default: install, build the programs, explore 20 s, and
                 print packages, MB, build steps, CPU seconds of the build, minutes to the first line of progress
Needs root and the package debootstrap. The sources as they are now, committed or not, are copied to FOLDER/lapis.
TEXT
}
stop() { echo "fresh_root.sh: $*" >&2; exit 2; }

folder="" release="" what=measure
# Packages come from where this machine gets its own, unless --mirror says otherwise.
# shellcheck disable=SC2016 # apt-get expands it
mirror="$(apt-get indextargets --format '$(REPO_URI)' 2>/dev/null | grep -v security | head -n 1 || true)"
while [[ $# -gt 0 ]]; do
  case "$1" in
    --release) release="${2:?--release needs a name}"; shift 2 ;;
    --mirror) mirror="${2:?--mirror needs a URL}"; shift 2 ;;
    --test) what="test"; shift ;;
    --help | -h) usage; exit 0 ;;
    -*) usage >&2; exit 2 ;;
    *) folder="$1"; shift ;;
  esac
done
[[ -n "$folder" && ("$release" == bookworm || "$release" == trixie) ]] || { usage >&2; exit 2; }
[[ $EUID -eq 0 ]] || stop "needs root (chroot)"
command -v debootstrap >/dev/null || stop "needs the package debootstrap"

if [[ ! -e "$folder/etc/os-release" ]]; then
  debootstrap --variant=minbase "$release" "$folder" ${mirror:+"$mirror"}
fi
folder="$(cd "$folder" && pwd)"
if [[ -e /etc/resolv.conf ]]; then cp -L /etc/resolv.conf "$folder/etc/resolv.conf"; fi
mkdir -p "$folder/lapis"
git -C "$root" ls-files -z --cached --others --exclude-standard |
  tar -C "$root" --null --ignore-failed-read -cf - -T - | tar -C "$folder/lapis" -xf -

# Runs in the root, from its own text.
test_there() {
  launch_scripts/setup.sh --dev && ctest --preset release -L "^(unit|contract)\$"
}
measure_there() {
  installed() { dpkg-query -W -f '${db:Status-Status} ${Installed-Size}\n' | awk '/^installed/ { n++; kB += $2 } END { print n, int(kB * 1.024e-3) }'; }
  local packages_before MB_before packages MB began=$SECONDS cpu
  read -r packages_before MB_before < <(installed)
  launch_scripts/setup.sh --no-build
  read -r packages MB < <(installed)
  echo "packages installed after $((SECONDS - began)) s"
  TIMEFORMAT='%U %S'
  { time launch_scripts/setup.sh >&3 2>&3; } 3>&1 2>/tmp/cpu
  cpu=$(awk '{ print int($1 + $2) }' /tmp/cpu)
  launch_scripts/explore.sh --duration 20 --out /tmp/run 2>&1 | while IFS= read -r line; do
    echo "$line"
    [[ "$line" != *" m driven"* || -e /tmp/first ]] || echo $((SECONDS - began)) >/tmp/first
  done
  echo "packages: $((packages - packages_before)), $((MB - MB_before)) MB"
  echo "build: $(grep -o '^@[0-9]*/[0-9]*' build/setup.log | tail -n 1 | cut -d / -f 2) steps, $cpu CPU s"
  echo "first line of progress of the exploration after $(($(cat /tmp/first) / 60)) min $(($(cat /tmp/first) % 60)) s"
}

# A mount namespace of its own: nothing stays mounted, whatever happens. The inner shell expands the text.
# shellcheck disable=SC2016
unshare --mount --propagation private bash -euo pipefail -c '
  for part in proc sys dev; do mount --rbind "/$part" "$1/$part"; done
  exec chroot "$1" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
    http_proxy="${http_proxy:-}" https_proxy="${https_proxy:-}" ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST \
    bash -euo pipefail -c "cd /lapis; $2"
' fresh_root "$folder" "rm -f /tmp/first; $(declare -f "${what}_there"); ${what}_there"
