#!/usr/bin/env bash
# Makes the feet of a sliding capture stand, then puts the walker's hand on a rail. See README.md.
#
#   run.sh [OUTPUT_FOLDER]
#
# Without an argument: out/reach_and_plant. The tools are found through $KROK_BIN or in build/bin,
# make-walk through $SAMPLES_BIN or in build/samples.
. "$(dirname "${BASH_SOURCE[0]}")/../story.sh"

check_arguments 1 "$@"
need_tools ik plot view
need_generators make-walk
enter_folder "${1:-out/reach_and_plant}"

say "1. A capture whose feet slide by 3 cm in each stance, and shake"
"$generators/make-walk" -q --steps 6 --step-length 65cm --slide 3cm --noise-position 1mm --seed 5 \
  -o sliding.bvh

say "2. Feet that stand"
"$bin/krok-ik" sliding.bvh --plant -o standing.anim --json=standing.report.json
"$bin/krok-plot" -q sliding.bvh standing.anim --joint LeftToeBase --show positions \
  --from 0.6s --to 1.4s --columns 3 --panel 220x160 -o stance.svg

say "3. A hand on a rail, and a look at it"
cp -- "$story/goals.json" .
"$bin/krok-ik" sliding.bvh --plant --goals goals.json --limits auto -o rail.anim \
  --plot rail.svg --json=rail.report.json -v

say "4. Images and a page"
"$bin/krok-plot" -q rail.anim --sheet moments.png --view front-right --actor-size 200 \
  --moments 0.3s,0.8s,1.2s,1.7s,2.2s,2.8s
"$bin/krok-plot" -q rail.anim --strip strip.png --moments 12 --view right --actor-size 200
"$bin/krok-view" -q sliding.bvh rail.anim --layout together --goals goals.json -o rail.html
echo "  stance.svg, rail.svg, moments.png, strip.png, rail.html"
