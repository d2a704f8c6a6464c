#!/usr/bin/env bash
# A bad reference pose ruins skinning: a mesh bound to a skeleton in another pose. See README.md.
#
#   run.sh [OUTPUT_FOLDER]
#
# Without an argument: out/bad_reference. The tools are found through $KROK_BIN or in build/bin,
# make-walk and make-bad-reference through $SAMPLES_BIN or in build/samples.
. "$(dirname "${BASH_SOURCE[0]}")/../story.sh"

check_arguments 1 "$@"
need_tools body skin diff plot
need_generators make-walk make-bad-reference
enter_folder "${1:-out/bad_reference}"

say "1. A body in its T-pose, and the same mesh bound with lowered arms"
"$generators/make-walk" -q --steps 2 -o walk.bvh
"$bin/krok-body" -q -o body.model -- walk.bvh
angles=(0 5 10 20 45)
for angle in "${angles[@]}"; do
  "$generators/make-bad-reference" -q --lower "${angle}deg" -o "bad$angle.model" -- body.model
done

say "2. Skinned with a walk: distance from the good one, and what krok-skin says"
{
  echo "| arms lowered by | bones outside of the mesh | largest distance | mean (RMS) |"
  echo "|---|---|---|---|"
  for angle in "${angles[@]}"; do
    "$bin/krok-skin" -q --as pose --time 0.5s --json=skin.json -o "bad$angle.glb" -- \
      "bad$angle.model" walk.bvh 2>/dev/null
    bones=$(awk '/of the reference pose lie/ { sub(/.*"message": "/, ""); print $1; found = 1 }
                 END { if (!found) print "none" }' skin.json)
    "$bin/krok-diff" -q --json=diff.json -- bad0.glb "bad$angle.glb" || true
    awk -v angle="$angle" -v bones="$bones" -F'[:,]' \
      '/"what": "positions"/ { at = 1 } at && /"largest"/ && !largest { largest = 1000 * $2 }
       at && /"rms"/ && !rms { rms = 1000 * $2; at = 0 }
       END { printf "| %s° | %s | %.0f mm | %.0f mm |\n", angle, bones, largest, rms }' diff.json
  done
} | tee reference.md
"$bin/krok-skin" --as pose --time 0.5s -o bad45.glb -- bad45.model walk.bvh

say "3. Picture"
"$bin/krok-plot" -q --sheet reference.png --view front --moments 0s --actor-size 280 --columns 4 -- \
  bad0.glb bad10.glb bad20.glb bad45.glb
echo "  reference.png   arms lowered by 0, 10, 20 and 45 degrees in the reference pose"
