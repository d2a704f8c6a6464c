#!/usr/bin/env bash
# From a motion capture to a skinned, animated glTF, with a check of the result. See README.md.
#
#   run.sh [--quick] [CAPTURE.bvh] [OUTPUT_FOLDER]
#
# Without arguments: samples/captures/walk.bvh to out/demo. With --quick: only the rig and the page,
# to out/quick, with four tools. The tools are found through $KROK_BIN, or in build/bin.
. "$(dirname "${BASH_SOURCE[0]}")/../story.sh"

# Durations to try, longest first, if the whole capture is too long to bake.
parts=(4s 2s 1s 0.5s)

quick=
[ "${1:-}" != --quick ] || { quick=yes && shift; }
check_arguments 2 "$@"
need_tools import body skin view
[ -n "$quick" ] || need_tools diff export info keys plot
capture=${1:-$story/../captures/walk.bvh}
out=${2:-out/$([ -n "$quick" ] && echo quick || echo demo)}
mkdir -p -- "$out" || fail "cannot make the folder $out"
out=$(cd -- "$out" && pwd)

name=$(basename -- "$capture")
name=${name%.*}
base=$out/$name

# made FILE WHAT: prints a line with the file's size.
made() {
  printf '  %9s  %s  (%s)\n' "$(du -h --apparent-size -- "$1" | cut -f1)B" "$1" "$2"
}

say "1. Import the capture"
# A T-pose before the motion, as in many captures, would flash up in a viewer.
"$bin/krok-import" --skip-rest-frame auto -o "$base.anim" -- "$capture"
made "$base.anim" "the motion: skeleton and frames"
[ -n "$quick" ] || "$bin/krok-info" -- "$base.anim"

say "2. Build a body around the skeleton"
"$bin/krok-body" -q -o "$base.model" -- "$base.anim"
made "$base.model" "a mesh with smooth weights"

say "3. Animate the body: as a rig, and baked"
"$bin/krok-skin" -q --as rig -o "${base}_rig.glb" -- "$base.model" "$base.anim"
made "${base}_rig.glb" "mesh, joints, weights, animation"

if [ -n "$quick" ]; then
  "$bin/krok-view" -q -o "$base.html" -- "$base.anim" "$base.model"
  made "$base.html" "a self-contained page that plays it in any browser"
  say "Done. Open $base.html in a browser; make demo shows the other tools."
  exit 0
fi

# Baking writes the whole mesh for each frame; krok-skin refuses sizes that viewers cannot show.
clip=${base}_clip.glb
same_rig=${base}_rig.glb
refusal=$(mktemp)
trap 'rm -f -- "$refusal"' EXIT
if ! "$bin/krok-skin" -q --as baked -o "$clip" -- "$base.model" "$base.anim" 2>"$refusal"; then
  grep -q '\[skin-clip-too-long\]' "$refusal" || { cat "$refusal" >&2 && exit 2; }
  baked=
  for part in "${parts[@]}"; do
    if "$bin/krok-skin" -q --as baked --to "$part" -o "$clip" -- "$base.model" "$base.anim" \
      2>"$refusal"; then
      baked=$part
      break
    fi
  done
  [ -n "$baked" ] || { cat "$refusal" >&2 && exit 2; }
  echo "  The capture is too long to be baked whole: the first $baked are baked; the rig has it all."
  same_rig=${base}_rig_part.glb
  "$bin/krok-skin" -q --as rig --to "$baked" -o "$same_rig" -- "$base.model" "$base.anim"
  made "$same_rig" "the rig of the same part, to compare"
fi
made "$clip" "the vertices of each frame, for viewers without skinning"

say "4. Compare both"
"$bin/krok-diff" --tolerance 0.01mm -- "$same_rig" "$clip" ||
  fail "the rig and the baked clip differ by more than 0.01 mm"

say "5. Export the motion"
for kind in csv bvh glb; do
  "$bin/krok-export" -q -o "${base}_motion.$kind" -- "$base.anim"
done
made "${base}_motion.csv" "world positions of the joints, for a spreadsheet"
made "${base}_motion.bvh" "the motion as BVH"
made "${base}_motion.glb" "the animated skeleton only"

say "6. Visualise"
# The page and charts show the keytimes; a motion without steps has none and does not need them.
"$bin/krok-keys" -q -o "$base.keys.json" -- "$base.anim" || rm -f -- "$base.keys.json"
[ ! -e "$base.keys.json" ] || made "$base.keys.json" "foot contacts and gait events"
"$bin/krok-view" -q -o "$base.html" -- "$base.anim" "$base.model"
made "$base.html" "a self-contained page that plays it in any browser"
"$bin/krok-plot" -q -o "$base.svg" --sheet "${base}_sheet.png" --strip "${base}_strip.png" \
  -- "$base.anim"
made "$base.svg" "path, feet and joint angles as charts"
made "${base}_sheet.png" "the character at eight moments, from the front and left"
made "${base}_strip.png" "the character along its path"

say "Done. Open $base.html in a browser, or drop ${base}_rig.glb into any glTF viewer."
