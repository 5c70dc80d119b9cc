#!/usr/bin/env bash
# Builds the runtime image without a daemon and explores 20 s in it.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"

usage() {
  cat <<TEXT
usage: docker/check.sh [--mirror URL]
Makes a Debian 12 root by debootstrap, tags it docker.io/library/debian:bookworm-slim (nothing is pulled), builds
docker/runtime/Dockerfile on it and runs explore.sh --duration 20 in the image. Images stay in a folder under build/docker, which is
removed at the end. Needs root, the packages debootstrap and buildah, 10 GB, and a quarter of an hour on two cores.
  --mirror URL  of Debian; default: where this machine gets its packages
TEXT
}
stop() { echo "check.sh: $*" >&2; exit 2; }

# shellcheck disable=SC2016 # apt-get expands it
mirror="$(apt-get indextargets --format '$(REPO_URI)' 2>/dev/null | grep -v security | head -n 1 || true)"
while [[ $# -gt 0 ]]; do
  case "$1" in
    --mirror) mirror="${2:?--mirror needs a URL}"; shift 2 ;;
    --help | -h) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
  esac
done
[[ $EUID -eq 0 ]] || stop "needs root"
for program in debootstrap buildah; do command -v $program >/dev/null || stop "needs the package $program"; done

mkdir -p "$root/build"
work="$(mktemp -d "$root/build/docker.XXXXXX")"
trap 'rm -rf "$work"' EXIT
export STORAGE_DRIVER=vfs CONTAINERS_STORAGE_CONF="$work/storage.conf"
printf '[storage]\ndriver = "vfs"\nrunroot = "%s"\ngraphroot = "%s"\n' "$work/run" "$work/images" >"$CONTAINERS_STORAGE_CONF"

echo "base: Debian 12 by debootstrap"
debootstrap --variant=minbase bookworm "$work/base" ${mirror:+"$mirror"} >"$work/debootstrap.log" ||
  { tail -n 5 "$work/debootstrap.log" >&2; stop "debootstrap failed"; }
base="$(buildah from scratch)"
buildah copy -q "$base" "$work/base" / >/dev/null
buildah config --cmd bash "$base"
buildah commit -q "$base" docker.io/library/debian:bookworm-slim >/dev/null
buildah rm "$base" >/dev/null
rm -rf "$work/base"

buildah bud --isolation chroot --network host --pull-never -f "$root/docker/runtime/Dockerfile" -t lapis "$root"
container="$(buildah from --pull-never lapis)"
buildah run --isolation chroot --network host --env ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST "$container" -- \
  explore.sh --duration 20 --out /out/run
buildah run --isolation chroot "$container" -- ls -l /out/run
echo "image: $(du -sm "$(buildah mount "$container")" | cut -f 1) MB"
