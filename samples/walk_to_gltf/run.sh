#!/usr/bin/env bash
# From a motion capture to a skinned, animated glTF, and back again to be sure. README.md tells the
# same story step by step.
#
#   run.sh [--quick] [CAPTURE.bvh] [OUTPUT_FOLDER]
#
# Without arguments: samples/captures/walk.bvh to out/demo. With --quick, to out/quick, the rig and the
# page alone, by four tools. The tools are found through $KROK_BIN, or in build/bin.
. "$(dirname "${BASH_SOURCE[0]}")/../story.sh"

# Longest parts to bake, in turn, where a whole capture is too long for that.
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

# made FILE WHAT: a line with the file's size.
made() {
  printf '  %9s  %s  (%s)\n' "$(du -h --apparent-size -- "$1" | cut -f1)B" "$1" "$2"
}

say "1. The capture becomes a motion"
# A T-pose in front of the motion, as many captures have it, would flash up in a viewer.
"$bin/krok-import" --skip-rest-frame auto -o "$base.anim" -- "$capture"
made "$base.anim" "the motion: skeleton and frames"
[ -n "$quick" ] || "$bin/krok-info" -- "$base.anim"

say "2. A body is built around the skeleton"
"$bin/krok-body" -q -o "$base.model" -- "$base.anim"
made "$base.model" "a mesh with smooth weights"

say "3. The body moves: as a rig, and baked"
"$bin/krok-skin" -q --as rig -o "${base}_rig.glb" -- "$base.model" "$base.anim"
made "${base}_rig.glb" "mesh, joints, weights, animation"

if [ -n "$quick" ]; then
  "$bin/krok-view" -q -o "$base.html" -- "$base.anim" "$base.model"
  made "$base.html" "a page that plays it, in any browser, from disk"
  say "Done. Open $base.html in a browser; make demo shows the other tools."
  exit 0
fi

# Baking writes the whole mesh for each frame; krok-skin refuses to where viewers could not show it.
clip=${base}_clip.glb
same_rig=${base}_rig.glb
refusal=$(mktemp)
trap 'rm -f -- "$refusal"' EXIT
if ! "$bin/krok-skin" -q --as clip -o "$clip" -- "$base.model" "$base.anim" 2>"$refusal"; then
  grep -q '\[skin-clip-too-long\]' "$refusal" || { cat "$refusal" >&2 && exit 2; }
  baked=
  for part in "${parts[@]}"; do
    if "$bin/krok-skin" -q --as clip --to "$part" -o "$clip" -- "$base.model" "$base.anim" \
      2>"$refusal"; then
      baked=$part
      break
    fi
  done
  [ -n "$baked" ] || { cat "$refusal" >&2 && exit 2; }
  echo "  The capture is too long to be baked whole: the first $baked are baked, the rig has it all."
  same_rig=${base}_rig_part.glb
  "$bin/krok-skin" -q --as rig --to "$baked" -o "$same_rig" -- "$base.model" "$base.anim"
  made "$same_rig" "the rig of the same part, to compare"
fi
made "$clip" "each frame's vertices, for viewers that know no skins"

say "4. Both ways show the same"
"$bin/krok-diff" --tolerance 0.01mm -- "$same_rig" "$clip" ||
  fail "the rig and the baked clip differ by more than 0.01 mm"

say "5. The motion goes on to other programs"
for kind in csv bvh glb; do
  "$bin/krok-export" -q -o "${base}_motion.$kind" -- "$base.anim"
done
made "${base}_motion.csv" "world positions of the joints, for a spreadsheet"
made "${base}_motion.bvh" "the motion as BVH again"
made "${base}_motion.glb" "the skeleton alone, animated"

say "6. Something to look at"
# Its keytimes stand in both; a motion without steps has none, and no picture needs them.
"$bin/krok-keys" -q -o "$base.keys.json" -- "$base.anim" || rm -f -- "$base.keys.json"
[ ! -e "$base.keys.json" ] || made "$base.keys.json" "when feet stand, and the keytimes of the gait"
"$bin/krok-view" -q -o "$base.html" -- "$base.anim" "$base.model"
made "$base.html" "a page that plays it, in any browser, from disk"
"$bin/krok-plot" -q -o "$base.svg" --sheet "${base}_sheet.png" --strip "${base}_strip.png" \
  -- "$base.anim"
made "$base.svg" "path, feet and joint angles as charts"
made "${base}_sheet.png" "the figure at eight moments, from the front and its left"
made "${base}_strip.png" "the same along its way"

say "Done. Open $base.html in a browser, or drop ${base}_rig.glb into any glTF viewer."
