#!/usr/bin/env bash
# Installs the Debian packages that are missing and builds the programs (release preset). Does nothing twice.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
sysctl_file=/etc/sysctl.d/60-lapis.conf
socket_buffer_bytes=8388608

usage() {
  cat <<TEXT
usage: launch_scripts/setup.sh [--dev] [--no-build] [--minimal] [--sysctl]
  --dev       also what changes and tests of Lapis need: packages of the group dev, tests; warnings are errors
  --no-build  only install packages (launch_scripts/packages.txt)
  --minimal   without the furniture of the simulator's scenes; simple shapes stand in
  --sysctl    also install $sysctl_file (socket buffers of up to 8 MiB)
Needs root or sudo when something is missing. What apt and the compiler say is in build/setup.log. Exit status 2: the
machine is not ready; 1: the build failed; the message says why.
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

# Lines of packages.txt in the wanted groups.
wanted_packages() {
  local line group=""
  while read -r line; do
    case "$line" in
      "" | "#"*) ;;
      "["*) group="${line//[\[\]]/}" ;;
      *) if [[ " ${groups[*]} " == *" $group "* && ("$extent" == full || "$line" != "?"*) ]]; then echo "${line#\?}"; fi ;;
    esac
  done <"$root/launch_scripts/packages.txt"
}

# with_progress WHAT COMMAND...: all that the command says goes into the log; one line says how far it is and how long the
# rest takes if it goes on as so far. Understands the steps of ninja and the status lines of apt-get.
with_progress() {
  local what="$1" status=0
  shift
  "$@" 2>&1 | tee -a "$log" | show_progress "$what" || status=$?
  [[ $status -eq 0 ]] || { echo "setup.sh: $what failed; the end of $log:" >&2; tail -n 20 "$log" >&2; exit 1; }
}
show_progress() {
  local line phase="" began=$SECONDS percent left shown=-10 text=""
  while IFS= read -r line; do
    if [[ "$line" =~ ^@([0-9]+)/([0-9]+)\  ]]; then
      percent=$((100 * BASH_REMATCH[1] / BASH_REMATCH[2])) text="$1: step ${BASH_REMATCH[1]} of ${BASH_REMATCH[2]}"
    elif [[ "$line" =~ ^(dl|pm)status:[^:]*:([0-9]+) ]]; then
      if [[ "$phase" != "${BASH_REMATCH[1]}" ]]; then phase="${BASH_REMATCH[1]}" began=$SECONDS shown=-10; fi
      percent=${BASH_REMATCH[2]} text="$1: download $percent %"
      [[ "$phase" == dl ]] || text="$1: unpacked and set up $percent %"
    else
      continue
    fi
    if [[ $percent -gt 0 ]]; then
      left=$(((SECONDS - began) * (100 - percent) / percent))
      text+=", about $((left / 60)) min $((left % 60)) s left"
    fi
    if [[ -t 1 ]]; then
      printf '\r\e[K%s' "$text"
    elif [[ $percent -ge $((shown + 10)) ]]; then
      echo "$text"
      shown=$percent
    fi
  done
  [[ -z "$text" || ! -t 1 ]] || echo
}

install_packages() {
  local entries entry name missing=() names=()
  mapfile -t entries < <(wanted_packages)
  if ! grep -Eqs '^ID(_LIKE)?=.*debian' /etc/os-release || ! type apt-get dpkg-query >/dev/null 2>&1; then
    stop "this is not Debian; install what your distribution has of these and build with cmake --preset release:" \
      $'\n'"${entries[*]}"
  fi
  for entry in "${entries[@]}"; do first_of is_installed "$entry" >/dev/null || missing+=("$entry"); done
  if [[ ${#missing[@]} -eq 0 ]]; then echo "packages: all ${#entries[@]} are installed"; return; fi
  echo "packages: installing ${missing[*]}"
  as_root apt-get update -q >>"$log" 2>&1 || stop "apt-get update failed; $log says why"
  for entry in "${missing[@]}"; do
    name="$(first_of is_available "$entry")" || stop "no package $entry in this release (Debian 12 and 13 have it)"
    names+=("$name")
  done
  with_progress "packages" as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends \
    -o APT::Status-Fd=1 "${names[@]}"
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

# A tree that has tests keeps them: without --dev only the programs are built there.
build_programs() {
  local options=() target=programs
  cd "$root"
  if [[ "$dev" == yes ]]; then
    options=(-D BUILD_TESTING=ON -D LAPIS_WARNINGS_AS_ERRORS=ON) target=all
  elif [[ ! -e build/release/CMakeCache.txt ]]; then
    options=(-D BUILD_TESTING=OFF)
  fi
  with_progress "configuration" cmake --preset release "${options[@]}"
  NINJA_STATUS="@%f/%t " with_progress "build" cmake --build --preset release --target "$target"
}

build=yes extent=full sysctl=hint dev=no groups=(run)
for argument in "$@"; do
  case "$argument" in
    --dev) dev=yes groups+=(dev) ;;
    --no-build) build=no ;;
    --minimal) extent=minimal ;;
    --sysctl) sysctl=install ;;
    --help | -h) usage; exit 0 ;;
    *) usage >&2; stop "unknown argument $argument" ;;
  esac
done
log="$root/build/setup.log"
mkdir -p "$root/build"
: >"$log"
install_packages
set_socket_buffers "$sysctl"
if [[ "$build" == yes ]]; then build_programs; fi
