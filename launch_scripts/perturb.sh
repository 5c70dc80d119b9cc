#!/usr/bin/env bash
# Plays recorded sequences with images as worse cameras give them, and prints a table.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR
source "$(dirname "$0")/lib.sh"

usage() {
  cat <<'TEXT'
usage: perturb.sh SEQUENCE... [--kinds KIND,...] [--out DIR] [--results FILE] [--table] [--set KEY=VALUE]...

Changes the images of each SEQUENCE (a folder in the layout of the TUM RGB-D benchmark, with camera.yaml and
associations.txt, images rectified) as worse cameras would give them, plays what comes of it with replay.sh, and prints a
table: share of the frames that were tracked, error of the trajectory (ATE, SE(3)), and CPU time of slam per frame, the
latter two also as ratios to those of the sequence as it is, and what slam says is wrong with the camera. Where
lapis_tracking_benchmark is built (cmake --build --preset release --target slam_tracking_benchmark), it plays the images,
too: error of OpenCV's plain chain of ORB, brute force and PnP, and the CPU time of a tracked frame as a ratio to its. Each run is a row of FILE as soon as it has ended, with a key
(hash of the sources, the sequence's lists and the settings); what has a row of the same key is not repeated.

  --kinds KIND,...  default: all of
                    none, every second, 7.5 Hz, gamma 0.4, gamma 2.5, exposure jumps, motion blur, rolling shutter,
                    depth late, holes, JPEG 60, depth +3 %, depth -3 %, focal length +3 %, focal length -3 %,
                    depth not registered, own depth camera, person
                    (blur and rolling shutter come of the turns in groundtruth.txt; late depth halves the rate, so that
                    'every second' is what to compare it with)
  --out DIR         run folders, and the changed sequences of runs that failed; default: out/perturbations
  --results FILE    rows; default: docs/results/perturbations.csv
  --table           no runs: the table of the rows that are there
  --set KEY=VALUE   configuration, as for replay.sh

Rows in which more than a tenth of the frames have less than 30 % usable pixels (with depth, neither black nor white) are
marked: nobody could track these. Goals of all others: 95 % tracked, ATE at most twice that of the sequence as it is.
Exit status: 0 done, 1 a run failed or a row has less than 95 % tracked, 2 bad set-up, 130 and 143 interrupted.
TEXT
}

for argument in "$@"; do
  case $argument in -h | --help) usage && exit 0 ;; esac
done
[ $# -gt 0 ] || { usage >&2; exit 2; }
[[ " $* " == *" --table "* ]] || require_build
PYTHONPATH=$repository/launch_scripts exec /usr/bin/python3 -B -m perturbations "$@"
