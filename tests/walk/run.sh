#!/usr/bin/env bash
# Fits step libraries to generated walks and measures random walks made with them, how their steps are
# joined, and how people's walk changes on slopes and stairs.
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
# Joins can be told only from examples at many frames a second.
mkdir fine && cd fine
for length in 50 65 80; do
  for turn in -20 0 20; do
    "$make_walk" -q --steps 4 --rate 480 --step-length ${length}cm --turn ${turn}deg -o turn_${length}_${turn}.bvh
  done
done
cat > fine.json <<'END'
{"schema": "krok.library/1", "steps": "auto", "examples": [{"clip": "turn_*.bvh"}],
 "parameters": [{"measures": "step.length"}, {"measures": "step.turn"}]}
END
"$bin/krok-fit" -q fine.json -o fine.steps
"$python" "$source/tests/walk/measure_joins.py" "$bin" fine.steps --check
cd ..
# Steps on the level only, on slopes and stairs.
sed 's/turn_\*.bvh/turn_*_0_0.bvh/; /"height"/d; /"turn"/d; s/\(tolerance": "0.1mm"}\),/\1/' library_turns.json > level.json
"$bin/krok-fit" -q level.json -o level.steps
"$python" "$source/tests/walk/measure_gait.py" "$bin" level.steps --check
"$python" "$source/tests/walk/run_scripts.py" "$bin" turning.steps --count "$count" --check
