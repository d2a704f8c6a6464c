#!/usr/bin/env bash
# Fits a step library to generated walks and measures random walks made with it.
#
#   run.sh BIN_FOLDER MAKE_WALK SOURCE_FOLDER [COUNT]
#
# Exit code 77 (skipped) without NumPy.
set -euo pipefail
bin=$1 make_walk=$2 source=$3 count=${4:-6}
python=/usr/bin/python3
"$python" -c "import numpy" 2>/dev/null || { echo "skipped: NumPy is not installed"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd -- "$folder"
for length in 50 65 80; do
  for rise in -12 0 12; do
    for turn in -20 0 20; do
      "$make_walk" -q --steps 6 --step-length ${length}cm --rise ${rise}cm --turn ${turn}deg --ground slope \
        -o turn_${length}_${rise}_${turn}.bvh
    done
  done
done
cp -- "$source/samples/step_library/library_turns.json" .
"$bin/krok-fit" -q library_turns.json -o turning.steps
"$python" "$source/tests/walk/run_scripts.py" "$bin" turning.steps --count "$count" --check
