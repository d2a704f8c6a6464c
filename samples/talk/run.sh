#!/usr/bin/env bash
# A generated face speaks a sentence, blinks, smiles, and looks at things. See README.md.
#
#   run.sh [OUTPUT_FOLDER]
#
# Without an argument: out/talk. The tools are found through $KROK_BIN or in build/bin.
. "$(dirname "${BASH_SOURCE[0]}")/../story.sh"

check_arguments 1 "$@"
need_tools import mix skin plot
enter_folder "${1:-out/talk}"

say "1. A face, an eye, and an idle motion"
python3 "$story/make_face.py" .
"$bin/krok-import" -q face.gltf -o idle.anim --save-character face.character
cp -- "$story/talk.character" "$story/talk.TextGrid" "$story/talk.json" .

say "2. Speech, expressions, blinks and gaze from the timeline"
"$bin/krok-mix" talk.json -o talk.anim --json=talk.report.json

say "3. The character, with eyeballs attached to the joints of its eyes"
"$bin/krok-skin" talk.character talk.anim --weights talk.weights.csv \
  --attach left_eye=eye.gltf --attach right_eye=eye.gltf -o talk.glb

say "4. Images"
"$bin/krok-plot" -q talk.glb --sheet talk.png --view front --actor-size 170 \
  --moments 0.55s,0.7s,1.22s,1.7s,1.9s,2.3s,2.63s,3.2s,3.7s,4.35s,5.6s,6.4s
echo "  talk.glb, talk.png"
