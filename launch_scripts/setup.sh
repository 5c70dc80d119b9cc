#!/usr/bin/env bash
# Installs the Debian packages that are missing and builds the release preset. Does nothing twice.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
sysctl_file=/etc/sysctl.d/60-lapis.conf
socket_buffer_bytes=8388608

usage() {
  cat <<TEXT
usage: launch_scripts/setup.sh [--no-build] [--minimal] [--sysctl]
  --no-build  only install packages (launch_scripts/packages.txt)
  --minimal   without the furniture of the simulator's scenes; simple shapes stand in
  --sysctl    also install $sysctl_file (socket buffers of up to 8 MiB)
Needs root or sudo when something is missing. Exit status 2: the machine is not ready; the message says why.
TEXT
}
stop() { echo "setup.sh: $*" >&2; exit 2; }
as_root() {
  if [[ $EUID -eq 0 ]]; then "$@"; return; fi
  command -v sudo >/dev/null || stop "needs root or sudo for: $*"
  sudo "$@"
}
# Names of installed packages and of what they provide (NodeSource's nodejs, for example, provides npm).
installed=" $({ dpkg-query -W -f='${db:Status-Status} ${Package} ${Provides}\n' 2>/dev/null || true; } |
  sed -n 's/^installed //p' | sed 's/([^)]*)//g' | tr ',\n' '  ')"
is_installed() { [[ "$installed" == *" $1 "* ]]; }
is_available() { apt-cache show --no-all-versions "$1" >/dev/null 2>&1; }

# First name of "a|b" for which the test holds.
first_of() {
  local test="$1" name
  for name in ${2//|/ }; do "$test" "$name" && { echo "$name"; return; }; done
  return 1
}

install_packages() {
  local entries entry name missing=() names=()
  local unwanted='#|$'
  [[ "$extent" == minimal ]] && unwanted+='|[?]'
  mapfile -t entries < <(grep -Ev "^[[:space:]]*($unwanted)" "$root/launch_scripts/packages.txt" | sed 's/^?//')
  if ! grep -Eqs '^ID(_LIKE)?=.*debian' /etc/os-release || ! type apt-get dpkg-query >/dev/null 2>&1; then
    stop "this is not Debian; install what your distribution has of these and build with cmake --preset release:" \
      $'\n'"${entries[*]}"
  fi
  for entry in "${entries[@]}"; do first_of is_installed "$entry" >/dev/null || missing+=("$entry"); done
  if [[ ${#missing[@]} -eq 0 ]]; then echo "packages: all ${#entries[@]} are installed"; return; fi
  echo "packages: installing ${missing[*]}"
  as_root apt-get update -q
  for entry in "${missing[@]}"; do
    name="$(first_of is_available "$entry")" || stop "no package $entry in this release (Debian 12 and 13 have it)"
    names+=("$name")
  done
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${names[@]}"
}

set_socket_buffers() {
  local text="net.core.rmem_max = $socket_buffer_bytes"$'\n'"net.core.wmem_max = $socket_buffer_bytes"
  if [[ "$1" == install ]]; then
    echo "$text" | as_root tee "$sysctl_file" >/dev/null
    local limit
    for limit in rmem_max wmem_max; do
      echo "$socket_buffer_bytes" | as_root tee "/proc/sys/net/core/$limit" >/dev/null ||
        echo "warning: net.core.$limit stays as it is until the next boot" >&2
    done
  elif [[ ! -e "$sysctl_file" && "$(cat /proc/sys/net/core/rmem_max 2>/dev/null || echo 0)" -lt 4194304 ]]; then
    echo "hint: small socket buffers slow image topics down; setup.sh --sysctl writes $sysctl_file:"
    echo "$text"
  fi
}

build=yes extent=full sysctl=hint
for argument in "$@"; do
  case "$argument" in
    --no-build) build=no ;;
    --minimal) extent=minimal ;;
    --sysctl) sysctl=install ;;
    --help | -h) usage; exit 0 ;;
    *) usage >&2; stop "unknown argument $argument" ;;
  esac
done
install_packages
set_socket_buffers "$sysctl"
if [[ "$build" == yes ]]; then
  cd "$root"
  cmake --preset release
  cmake --build --preset release
fi
