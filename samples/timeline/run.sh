#!/usr/bin/env bash
# Combines six motions: sets off, walks and waves, turns, limps, stops, looks aside, waves goodbye.
# See README.md.
#
#   run.sh [OUTPUT_FOLDER]
#
# Without an argument: out/timeline. The tools are found through $KROK_BIN or in build/bin, make-walk
# and make-gesture through $SAMPLES_BIN or in build/samples.
. "$(dirname "${BASH_SOURCE[0]}")/../story.sh"

check_arguments 1 "$@"
need_tools mix cam body skin view plot
need_generators make-walk make-gesture
enter_folder "${1:-out/timeline}"

say "1. Six motions"
"$generators/make-walk" --steps 8 --from-standing -o standing.bvh
"$generators/make-walk" --steps 8 -o walk.bvh
"$generators/make-walk" --steps 6 --step-length 65cm --turn 15deg -o turn.bvh
"$generators/make-gesture" --kind wave --duration 3s -o wave.bvh
"$generators/make-gesture" --kind limp --side left --duration 1.1s -o limp.bvh
"$generators/make-gesture" --kind look --side left --duration 2.5s -o look.bvh

say "2. One motion from the timeline"
cp -- "$story/timeline.json" .
"$bin/krok-mix" timeline.json -o story.anim --json=story.report.json

say "3. A body, and a camera that follows"
"$bin/krok-body" -q -o walker.model -- story.anim
"$bin/krok-cam" story.anim --follow hips -o story.cam
"$bin/krok-skin" -q walker.model story.anim --as rig -o story.glb
"$bin/krok-view" -q walker.model story.anim story.cam -o story.html

say "4. Images"
"$bin/krok-plot" -q story.anim --strip story.png --moments 16 --view left --actor-size 200
"$bin/krok-plot" -q story.anim --sheet moments.png --view front-left --actor-size 170 \
  --moments 1.2s,3.6s,6.5s,10.9s,15s,19.5s,21.3s,23.5s
echo "  story.html, story.glb, story.png, moments.png"
