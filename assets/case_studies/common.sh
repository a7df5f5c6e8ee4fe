#!/bin/bash
# Read by each case study: usage, sizes and the looks of pictures.
#
#     assets/case_studies/NAME OUTPUT [small] [SHVR]
#
# OUTPUT is a folder, which is made; a folder of an earlier run there is replaced.
set -euo pipefail

here=$(dirname "${BASH_SOURCE[0]}")
[[ $# -ge 1 && $1 != -* ]] || {
    echo "usage: $0 OUTPUT [small] [SHVR]"
    exit 2
}
output=$1
is_small=false
[[ ${2:-} == small ]] && is_small=true
shvr=${3:-build/release/shvr}
pixels=480x400
$is_small && pixels=60x50

hand() { python3 "$here/hand.py" "$@"; }
step() { echo "== $*"; }
draw()  # FIGURE SESSION|PROJECT|VOLUME OPTION...
{
    local figure=$1
    shift
    "$shvr" render "$1" -o "$output/$figure.png" --size "$pixels" --quiet "${@:2}" > /dev/null
}
# Prints a number of a JSON file: `number scores.json dice`, `number scores.json node_out 0`
number() { python3 -c 'import json, sys
value = json.load(open(sys.argv[1]))
for key in sys.argv[2:]: value = value[int(key) if isinstance(value, list) else key]
print(round(value, 4))' "$@"; }

mkdir -p "$output"
