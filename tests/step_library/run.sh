#!/usr/bin/env bash
# Fits libraries to generated walks that agree and to others that contradict each other, and checks that the
# default predicts walks left out about as well as the best simple way to make weights.
#
#   run.sh BIN_FOLDER MAKE_WALK SOURCE_FOLDER
#
# Exit code 77 (skipped) without NumPy.
set -euo pipefail
bin=$1 make_walk=$2 source=$3
python=/usr/bin/python3
"$python" -c "import numpy" 2>/dev/null || { echo "skipped: NumPy is not installed"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
cd -- "$folder"
seed=0
for length in 50 55 60 65 70 75 80; do
  for cadence in 90 115; do
    seed=$((seed + 1))
    "$make_walk" -q --steps 6 --step-length ${length}cm --cadence $cadence -o agree_${length}_$cadence.bvh
    # Widths and turns are no parameters here, so that steps alike in length and duration differ.
    "$make_walk" -q --steps 6 --step-length ${length}cm --cadence $cadence --step-width $((6 + seed * 7 % 15))cm \
      --turn $((seed * 5 % 9 - 4))deg --rate 30 --noise-angle 0.2deg --noise-position 0.5mm --seed $seed \
      -o differ_${length}_$cadence.bvh
  done
done
held_out() {
  "$python" "$source/tests/step_library/held_out.py" "$bin" "$@" --only planes,nearest,cubic,default --check
}
held_out agree_*.bvh
held_out differ_*.bvh --mirror
