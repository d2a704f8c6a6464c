#!/usr/bin/env bash
# Walks along a drawn way over a hill, up stairs and across stepping stones. See README.md.
#
#   run.sh [OUTPUT_FOLDER]
#
# Without an argument: out/walk_on_terrain. The tools are found through $KROK_BIN or in build/bin,
# make-walk through $SAMPLES_BIN or in build/samples.
. "$(dirname "${BASH_SOURCE[0]}")/../story.sh"

check_arguments 1 "$@"
need_tools fit walk body skin plot view retarget
need_generators make-walk
enter_folder "${1:-out/walk_on_terrain}"

say "1. A library of 27 steps: three lengths, three slopes, three turns"
for length in 50 65 80; do
  for rise in -12 0 12; do
    for turn in -20 0 20; do
      "$generators/make-walk" -q --steps 6 --step-length ${length}cm --rise ${rise}cm --turn ${turn}deg \
        --ground slope -o turn_${length}_${rise}_${turn}.bvh
    done
  done
done
cp -- "$story/../step_library/library_turns.json" "$story/way.svg" .
"$bin/krok-fit" -q library_turns.json -o walking.steps

say "2. Along a way drawn over a hill"
awk 'BEGIN {
  columns = 81; rows = 101
  for (r = 0; r < rows; r++) for (c = 0; c < columns; c++) {
    x = -4 + c * 0.1; z = -1 + r * 0.1
    near = z < 0 ? 0 : z > 1 ? 1 : z
    y = 0.6 * exp(-((x - 0.6) ^ 2 / 3 + (z - 4.2) ^ 2 / 4)) + near * 0.02 * sin(3 * x) * cos(2.3 * z)
    printf "v %.4f %.4f %.4f\n", x, near * y, z
  }
  for (r = 1; r < rows; r++) for (c = 1; c < columns; c++) {
    i = (r - 1) * columns + c
    printf "f %d %d %d %d\n", i, i + columns, i + columns + 1, i + 1
  }
}' > hill.obj
"$bin/krok-walk" walking.steps --path way.svg --ground hill.obj --save-prints prints.csv \
  -o hill.anim --json=hill.json --save-page hill.html

say "3. Up stairs"
stairs=stairs:rise=17cm,run=29cm,count=8
"$bin/krok-walk" walking.steps --goal 0m,5m --ground $stairs -o stairs.anim --json=stairs.json \
  --save-prints stairs_prints.csv --save-page stairs.html

say "4. Across stepping stones, on footprints made by hand"
cp -- "$story/stones.csv" .
awk -F, 'NR > 1 {
  x = $2; z = $3 + 0.11; turn = $4 * atan2(0, -1) / 180; y = $5
  for (level = 0; level < 2; level++) for (k = 0; k < 4; k++) {
    a = (k == 1 || k == 2) ? 0.12 : -0.12; b = k < 2 ? -0.2 : 0.2
    printf "v %.4f %.4f %.4f\n", x + a * cos(turn) + b * sin(turn), level ? y : y - 0.4,
      z - a * sin(turn) + b * cos(turn)
  }
  n = 8 * (NR - 2)
  printf "f %d %d %d %d\nf %d %d %d %d\n", n+8, n+7, n+6, n+5, n+1, n+2, n+3, n+4
  for (k = 1; k <= 4; k++) {
    m = k % 4 + 1
    printf "f %d %d %d %d\n", n + m, n + k, n + k + 4, n + m + 4
  }
}' stones.csv > stones.obj
"$bin/krok-walk" walking.steps --prints stones.csv --ground stones.obj -o stones.anim --json=stones.json \
  --save-page stones.html

say "5. A skinned walker, and another actor on the same stairs"
"$bin/krok-body" -q hill.anim -o walker.model
"$bin/krok-skin" -q walker.model hill.anim -o hill.glb --as rig
"$generators/make-walk" -q --stature 1.35m --step-length 50cm --steps 2 -o child.bvh
"$bin/krok-retarget" stairs.anim --onto child.bvh --ground $stairs -o child.anim --json=child.json
"$bin/krok-view" -q stairs.anim child.anim --ground $stairs --prints stairs_prints.csv -o child.html

say "6. Images and charts"
"$bin/krok-plot" -q hill.anim --ground hill.obj --prints prints.csv --strip hill.png --moments 18 \
  --view right --actor-size 200 --show path,feet -o hill.svg
"$bin/krok-plot" -q child.anim --ground $stairs --prints stairs_prints.csv --sheet stairs.png \
  --whole-ground --moments 3 --view back-left --elevation 20deg --actor-size 200
"$bin/krok-plot" -q stones.anim --ground stones.obj --prints stones.csv --sheet stones.png \
  --whole-ground --moments 3 --view front-left --elevation 20deg --actor-size 200
echo "  hill.glb, hill.png, stairs.png, stones.png, hill.svg"
say "Done. Open hill.html, stairs.html, stones.html and child.html in a browser."
