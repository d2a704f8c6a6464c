#!/usr/bin/env bash
# Builds step libraries from captures and synthesises steps from them. See README.md.
#
#   run.sh [CAPTURES_FOLDER [OUTPUT_FOLDER]]
#
# Without arguments, captures are generated, and results go to out/captured_steps. The tools are found
# through $KROK_BIN or in build/bin, make-walk through $SAMPLES_BIN or in build/samples.
. "$(dirname "${BASH_SOURCE[0]}")/../story.sh"

check_arguments 2 "$@"
need_tools keys fit synth plot walk
captures=${1:+$(cd -- "$1" 2>/dev/null && pwd)} || fail "no folder $1"
enter_folder "${2:-out/captured_steps}"

if [ -z "$captures" ]; then
  need_generators make-walk
  say "1. Captures: 14 walks and 6 backward, at 30 frames per second, below a root that stays at the origin"
  captures=$PWD/captures
  mkdir -p captures
  seed=0
  for length in 50 55 60 65 70 75 80; do
    for cadence in 90 115; do
      seed=$((seed + 1))
      # The same person never walks twice alike: other widths and turns, and jitter of the capture.
      "$generators/make-walk" -q --rig static-root --steps 6 --step-length ${length}cm --cadence $cadence \
        --step-width $((6 + seed * 7 % 15))cm --turn $((seed * 5 % 9 - 4))deg --rate 30 \
        --noise-angle 0.2deg --noise-position 0.5mm --seed $seed -o captures/walk_$seed.bvh
    done
  done
  for length in 35 45 55; do
    for cadence in 80 100; do
      seed=$((seed + 1))
      "$generators/make-walk" -q --rig static-root --backward --steps 6 --step-length ${length}cm \
        --cadence $cadence --rate 30 --noise-angle 0.2deg --noise-position 0.5mm --seed $seed \
        -o captures/backward_$seed.bvh
    done
  done
fi
echo "  $(find "$captures" -name '*.bvh' | wc -l) captures"

# describe NAME KIND: a library of the captures' steps of that kind by length and duration.
describe() {
  cat > "$1.json" <<JSON
{"schema": "krok.library/1", "name": "$1", "steps": "$2", "mirror": true,
 "parameters": [{"name": "length", "measures": "step.length", "tolerance": "1mm"},
                {"name": "duration", "measures": "duration", "tolerance": "5ms"}],
 "examples": [{"clip": "$captures/*.bvh"}]}
JSON
}

say "2. A library of steps forward, and one of steps backward where there are any"
describe forward auto
describe backward backward
"$bin/krok-fit" forward.json -o forward.steps --keep-going --json=forward_fit.json --plot charts ||
  [ $? -eq 3 ] # some captures were left out
"$bin/krok-fit" backward.json -o backward.steps --keep-going --json=backward_fit.json ||
  [ -e backward.steps ] || echo "  no library of steps backward"

say "3. Walks of these steps"
"$bin/krok-walk" forward.steps --goal 0,4m -o walk.anim
[ ! -e backward.steps ] || "$bin/krok-walk" backward.steps --goal 0,-3m -o walk_back.anim

say "4. Images"
"$bin/krok-plot" -q --strip walk.png walk.anim
[ ! -e walk_back.anim ] || "$bin/krok-plot" -q --strip walk_back.png walk_back.anim
echo "  walk.png, walk_back.png, charts/*.svg"
