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

# a slice with a failed check ends with 1 and is merged all the same; anything else stops
slice() {
    local status=0
    $fisura verify --partition "slice:$1/$slices" --out "$out/part-$1" --threads "${THREADS:-1}" --quiet "${@:2}" \
        >"$out/part-$1.log" || status=$?
    [ "$status" -le 1 ]
}
export -f slice
SHELL=$(type -p bash)
export SHELL
export slices out fisura

mkdir -p "$out"
seq "$slices" | parallel --will-cite --halt now,fail=1 --jobs "${JOBS:-2}" slice {} "$@"
parts=$(seq -f "$out/part-%.0f" "$slices")
# shellcheck disable=SC2086
$fisura merge $parts --out "$out/merged"
