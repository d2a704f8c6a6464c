#!/usr/bin/env bash
# Regenerates the captures in this folder: make.sh [OUTPUT_FOLDER]. Uses $MAKE_WALK, or make-walk in
# build/samples.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
make_walk=${MAKE_WALK:-$here/../../build/samples/make-walk}
out=${1:-$here}
mkdir -p "$out"

"$make_walk" --steps 8 -o "$out/walk.bvh"
"$make_walk" --steps 6 --step-length 32cm --rise 16cm --from-standing -o "$out/stairs.bvh"
"$make_walk" --steps 6 --step-length 65cm --turn 15deg -o "$out/turn.bvh"
