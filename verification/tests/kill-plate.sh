#!/bin/sh
# Kills the run of the plate with SIGKILL at ten random moments, takes it up again each time, and compares history.csv and every
# picture with those of a run that nobody disturbed. Ends with 0 if they are the same bytes. Arguments: those of `run`, such as
# --set "mesh.cells=[100, 40]"; the plate as it stands takes some minutes twice.
set -eu
cd "$(dirname "$0")/../.."
test -n "${XTASK:-}" || cargo build --quiet --package xtask
xtask=${XTASK:-${CARGO_TARGET_DIR:-target}/debug/xtask} # XTASK names a binary that is built already
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
run() { "$xtask" run verification/scenes/plate.toml --quiet "$@"; }

begin=$(date +%s)
run --out "$folder/undisturbed" "$@" > /dev/null
whole=$(($(date +%s) - begin + 1))
echo "undisturbed: $whole s"

kills=0
while [ "$kills" -lt 10 ]; do
    # not through the function: its subshell would be killed, and not the run
    "$xtask" run verification/scenes/plate.toml --quiet --out "$folder/killed" --resume --checkpoint 0.5 "$@" > /dev/null &
    pid=$!
    sleep "$(awk -v n="$kills" -v most="$whole" 'BEGIN { srand(n + '"$(date +%N | sed 's/^0*//')"'); print 0.2 + rand() * most / 6 }')"
    if kill -9 "$pid" 2> /dev/null; then
        kills=$((kills + 1))
        echo "killed: $kills"
    else
        echo "it ended before kill $((kills + 1)); begin anew"
        rm -rf "$folder/killed"
    fi
    wait "$pid" 2> /dev/null || true
    test ! -e "$folder/killed/summary.json" || { echo "an unfinished run looks finished"; exit 1; }
done
run --out "$folder/killed" --resume "$@" > /dev/null
for file in "$folder"/undisturbed/*; do
    name=$(basename "$file")
    test "$name" = summary.json || test "$name" = fisura.sha256 || cmp "$file" "$folder/killed/$name"
done
test "$(ls "$folder/killed")" = "$(ls "$folder/undisturbed")"
echo "history.csv and all pictures are the same bytes after $kills kills"
