#!/usr/bin/env bash
# Libraries of reaches and kicks, and a walk that ends in a reach and a kick. See README.md.
#
#   run.sh [OUTPUT_FOLDER]
#
# Without an argument: out/reach_and_kick. The tools are found through $KROK_BIN or in build/bin,
# make-action and make-walk through $SAMPLES_BIN or in build/samples.
. "$(dirname "${BASH_SOURCE[0]}")/../story.sh"

check_arguments 1 "$@"
need_tools fit synth plot view
need_generators make-action make-walk
enter_folder "${1:-out/reach_and_kick}"

say "1. Examples: 27 reaches to the points of a grid of 30 x 30 x 18 cm, 9 kicks"
for across in 10 25 40; do
  for up in 95 110 125; do
    for along in 54 63 72; do
      "$generators/make-action" -q --target ${across}cm,${up}cm,${along}cm \
        -o reach_${across}_${up}_${along}.bvh
    done
  done
done
for side in 5 20 35; do
  for height in 20 35 50; do
    "$generators/make-action" -q --kind kick --target ${side}cm,${height}cm,55cm \
      -o kick_${side}_${height}.bvh
  done
done
cp -- "$story"/*.json "$story/points.csv" .

say "2. Libraries, unrefined and with up to 80 points inserted; errors at 1,000 other points"
"$bin/krok-fit" reaches.json -o unrefined.steps --refine 0 --holdout 1000 --json=unrefined.json
"$bin/krok-fit" reaches.json -o reaches.steps --refine 80 --holdout 1000 --plot charts --json=fit.json
"$bin/krok-fit" kicks.json -o kicks.steps --json=kicks.fit.json

say "3. Reaches to five points"
mkdir -p sheet
"$bin/krok-synth" reaches.steps --points points.csv --correct -o sheet/reach.anim

say "4. A walk, then a reach to a place in the world, then a kick"
"$generators/make-walk" -q --steps 4 --from-standing -o walk.bvh
"$bin/krok-synth" reaches.steps --after walk.bvh --place -0.25m,1.15m,3.45m --plant -o reach.anim \
  --json=reach.report.json
"$bin/krok-synth" kicks.steps --after reach.anim --set side=15cm --set height=30cm --plant \
  -o all.anim --json=all.report.json

say "5. Images and a page"
"$bin/krok-plot" -q --sheet=reaches.png --view left --moments 5 --actor-size 150 sheet/reach_*.anim
"$bin/krok-plot" -q all.anim --strip strip.png --moments 14 --view left --actor-size 170
"$bin/krok-view" -q all.anim -o all.html
echo "  charts/*.svg, reaches.png, strip.png, all.html"
