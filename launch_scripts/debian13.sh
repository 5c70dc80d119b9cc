#!/usr/bin/env bash
# Builds Lapis in a Debian 13 root (Fast DDS 3.1) and runs its unit and contract tests there.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"

usage() {
  cat <<TEXT
usage: launch_scripts/debian13.sh FOLDER [--mirror URL]
  FOLDER  the Debian 13 root; made by debootstrap when it does not exist (4 GB), used again otherwise
Needs root and the package debootstrap. The sources as they are now, committed or not, are copied to FOLDER/lapis.
TEXT
}
stop() { echo "debian13.sh: $*" >&2; exit 2; }

folder=""
# Packages come from where this machine gets its own, unless --mirror says otherwise.
# shellcheck disable=SC2016 # apt-get expands it
mirror="$(apt-get indextargets --format '$(REPO_URI)' 2>/dev/null | grep -v security | head -n 1 || true)"
while [[ $# -gt 0 ]]; do
  case "$1" in
    --mirror) mirror="${2:?--mirror needs a URL}"; shift 2 ;;
    --help | -h) usage; exit 0 ;;
    -*) usage >&2; exit 2 ;;
    *) folder="$1"; shift ;;
  esac
done
[[ -n "$folder" ]] || { usage >&2; exit 2; }
[[ $EUID -eq 0 ]] || stop "needs root (chroot)"
command -v debootstrap >/dev/null || stop "needs the package debootstrap"

if [[ ! -e "$folder/etc/os-release" ]]; then
  debootstrap --variant=minbase trixie "$folder" ${mirror:+"$mirror"}
fi
folder="$(cd "$folder" && pwd)"
if [[ -e /etc/resolv.conf ]]; then cp -L /etc/resolv.conf "$folder/etc/resolv.conf"; fi
mkdir -p "$folder/lapis"
git -C "$root" ls-files -z --cached --others --exclude-standard |
  tar -C "$root" --null --ignore-failed-read -cf - -T - | tar -C "$folder/lapis" -xf -

# A mount namespace of its own: nothing stays mounted, whatever happens. The inner shell expands the text.
# shellcheck disable=SC2016
unshare --mount --propagation private bash -euo pipefail -c '
  for part in proc sys dev; do mount --rbind "/$part" "$1/$part"; done
  exec chroot "$1" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 \
    http_proxy="${http_proxy:-}" https_proxy="${https_proxy:-}" ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST \
    bash -euo pipefail -c "cd /lapis && launch_scripts/setup.sh --dev && ctest --preset release -L \"^(unit|contract)\$\""
' debian13 "$folder"
