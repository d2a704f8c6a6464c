#!/usr/bin/env bash
# Joint positions with noise become a BVH file, and a character whose feet stand. See README.md.
#
#   run.sh [OUTPUT_FOLDER]
#
# Without an argument: out/from_positions. The tools are found through $KROK_BIN or in build/bin,
# make-walk through $SAMPLES_BIN or in build/samples. Needs Python with numpy.
. "$(dirname "${BASH_SOURCE[0]}")/../story.sh"

check_arguments 1 "$@"
need_tools body edit export import plot skin
need_generators make-walk
python=python3
"$python" -c 'import numpy' 2>/dev/null || python=/usr/bin/python3
"$python" -c 'import numpy' 2>/dev/null || fail "Python has no numpy" "apt install python3-numpy"
enter_folder "${1:-out/from_positions}"

say "1. Positions of 22 joints, as a generative model or a pose estimator gives them: 5 mm of noise"
"$generators/make-walk" -q --steps 6 --step-length 65cm --seed 5 -o walk.bvh
"$bin/krok-export" -q walk.bvh -o walk.npz
"$python" "$story/positions.py" walk.npz joints.npy 5
"$python" "$story/positions.py" walk.npz truth.npy

say "2. A skeleton with rotations"
"$bin/krok-import" joints.npy --skeleton humanml22 --fps 60 -o found.anim -v
"$bin/krok-import" -q truth.npy --skeleton humanml22 --fps 60 -o truth.anim
"$bin/krok-export" found.anim -o found.bvh

say "3. Feet that stand, and a body"
"$bin/krok-edit" found.anim --plant -o planted.anim
"$bin/krok-body" -q planted.anim -o walker.model
"$bin/krok-skin" -q walker.model planted.anim -o walker.glb

say "4. Images"
"$bin/krok-plot" -q planted.anim --sheet moments.png --view front-right --actor-size 200 \
  --moments 0.5s,1s,1.5s,2s,2.5s,3s
"$bin/krok-plot" -q truth.anim found.anim planted.anim --joint left_foot --show positions \
  --from 0.6s --to 2s --columns 3 --panel 220x160 -o foot.svg
echo "  found.bvh, walker.glb, moments.png, foot.svg"
