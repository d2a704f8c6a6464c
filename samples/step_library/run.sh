#!/usr/bin/env bash
# Builds step libraries from walks and synthesises steps from them. See README.md.
#
#   run.sh [OUTPUT_FOLDER]
#
# Without an argument: out/step_library. The tools are found through $KROK_BIN or in build/bin,
# make-walk through $SAMPLES_BIN or in build/samples.
. "$(dirname "${BASH_SOURCE[0]}")/../story.sh"

check_arguments 1 "$@"
need_tools fit synth plot
need_generators make-walk
enter_folder "${1:-out/step_library}"

say "1. Examples: 9 walks of three step lengths on three slopes, 27 with turns, 54 with two widths"
for length in 50 65 80; do
  for rise in -12 0 12; do
    "$generators/make-walk" -q --steps 6 --step-length ${length}cm --rise ${rise}cm --ground slope \
      -o walk_${length}_${rise}.bvh
    for turn in -20 0 20; do
      "$generators/make-walk" -q --steps 6 --step-length ${length}cm --rise ${rise}cm --turn ${turn}deg \
        --ground slope -o turn_${length}_${rise}_${turn}.bvh
      for width in 8 20; do
        "$generators/make-walk" -q --steps 4 --step-length ${length}cm --rise ${rise}cm --turn ${turn}deg \
          --step-width ${width}cm --ground slope -o wide_${length}_${rise}_${turn}_${width}.bvh
      done
    done
  done
done
cp -- "$story"/library*.json .
echo "  $(ls walk_*.bvh turn_*.bvh wide_*.bvh | wc -l) captures"

say "2. A library of their left steps by length and height, refined"
"$bin/krok-fit" library.json -o unrefined.steps --refine 0
"$bin/krok-fit" library.json -o walking.steps --plot charts --json=fit.json

say "3. Libraries with three parameters (turn) and four (width)"
"$bin/krok-fit" library_turns.json -o turning.steps --plot charts_turns --json=fit_turns.json
"$bin/krok-fit" library_widths.json -o any.steps --plot charts_widths --json=fit_widths.json

say "4. A library of steps that contradict each other, as captured ones do"
seed=0
for length in 50 55 60 65 70 75 80; do
  for cadence in 90 115; do
    seed=$((seed + 1))
    # The same person never walks twice alike: other widths and turns, which are no parameters here,
    # and jitter of the capture.
    "$generators/make-walk" -q --steps 6 --step-length ${length}cm --cadence $cadence \
      --step-width $((6 + seed * 7 % 15))cm --turn $((seed * 5 % 9 - 4))deg --rate 30 \
      --noise-angle 0.2deg --noise-position 0.5mm --seed $seed -o captured_${length}_$cadence.bvh
  done
done
"$bin/krok-fit" library_captured.json -o captured.steps --json=fit_captured.json
"$bin/krok-fit" library_captured.json -o exact.steps --kernel cubic --smoothing 0 --json=fit_exact.json

say "5. Synthesise steps"
"$bin/krok-synth" walking.steps --set length=57cm --set height=3cm -o step.anim
"$bin/krok-synth" walking.steps --set length=57cm --set height=3cm --correct --side right \
  -o step_right.anim
mkdir -p sheet
"$bin/krok-synth" walking.steps --points "$story/points.csv" -o sheet/step.anim
"$bin/krok-synth" turning.steps --set length=60cm --set height=0 --set turn=14deg -o bend.anim

"$bin/krok-synth" captured.steps --set length=62cm --set duration=0.6s --plant -o captured.anim

say "6. Images"
"$bin/krok-plot" -q --sheet=steps.png --view left --moments 5 --actor-size 150 sheet/step_*.anim
echo "  steps.png, charts/*.svg, charts_turns/*.svg, charts_widths/*.svg"
