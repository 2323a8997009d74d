#!/usr/bin/env bash
# All slices of a verification with GNU parallel, then their merge.
#
#   xtask/templates/parallel.sh SLICES OUT [selection of verify …]
#   xtask/templates/parallel.sh 4 target/fisura/parallel --tier full
#
# FISURA is the command to run, `cargo xtask` unless set; JOBS slices run at a time, each on THREADS threads.
set -euo pipefail
slices=$1 out=$2
shift 2
fisura=${FISURA:-cargo xtask}

# a slice with a failed check ends with 1, one with a case that broke down with 3: both are merged all the same
slice() {
    local status=0
    $fisura verify --partition "slice:$1/$slices" --out "$out/part-$1" --threads "${THREADS:-1}" --quiet "${@:2}" \
        >"$out/part-$1.log" || status=$?
    case $status in 0 | 1 | 3) ;; *) echo "slice $1 ended with $status" >&2 ;; esac
}
export -f slice
SHELL=$(type -p bash)
export SHELL
export slices out fisura

mkdir -p "$out"
seq "$slices" | parallel --will-cite --jobs "${JOBS:-2}" slice {} "$@"
parts=$(seq -f "$out/part-%.0f" "$slices")
# the merge gives the verdict, and names slices that are missing
# shellcheck disable=SC2086
$fisura merge $parts --out "$out/merged"
