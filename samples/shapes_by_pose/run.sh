#!/usr/bin/env bash
# Shapes by pose: elbow, knee, shoulder and wrist of a body keep their volume. See README.md.
#
#   run.sh [OUTPUT_FOLDER]
#
# Without an argument: out/shapes_by_pose. The tools are found through $KROK_BIN or in build/bin,
# make-walk and make-sculpts through $SAMPLES_BIN or in build/samples.
. "$(dirname "${BASH_SOURCE[0]}")/../story.sh"

check_arguments 1 "$@"
need_tools body skin fit cam render
need_generators make-walk make-sculpts
enter_folder "${1:-out/shapes_by_pose}"

say "1. A body, and how it should look in 100 poses"
"$generators/make-walk" -q --steps 2 -o walk.bvh
"$bin/krok-body" -q -o body.model -- walk.bvh
"$generators/make-sculpts" -o correctives.json -- body.model

say "2. Correctives from five examples of each joint, and their error on 20 held-out poses"
"$bin/krok-fit" -o body.correctives --json=fit.json -- correctives.json

say "3. Skinned with and without them, and with twist joints"
"$bin/krok-skin" -q --as pose -o rest.obj -- body.model
"$bin/krok-skin" -q --as rig --correctives body.correctives -o rig.glb -- body.model show.anim
skin() { # NAME OPTION...
  local name=$1
  shift
  "$bin/krok-skin" -q --as frames "$@" -o "$name.obj" -- body.model show.anim
  "$bin/krok-skin" -q --as baked "$@" -o "$name.glb" -- body.model show.anim
}
skin linear
skin dual-quaternion --method dual-quaternion
skin spherical --method spherical
skin corrected --correctives body.correctives
skin twist1 --twist-joints forearm
skin twist2 --twist-joints forearm=2
skin twist4 --twist-joints forearm=4

say "4. Volume within 12 cm of the joint, percent lost"
methods=(linear dual-quaternion spherical twist1 twist2 twist4 corrected)
{
  echo "| joint | linear | dual quaternion | spherical | 1 twist joint | 2 | 4 | correctives |"
  echo "|---|---|---|---|---|---|---|---|"
  frame=0
  while IFS=, read -r joint x y z; do
    files=("${methods[@]/%/_000$frame.obj}")
    echo "| $joint |$(python3 "$story/volume.py" "$x" "$y" "$z" 0.12 rest.obj "${files[@]}" |
      awk 'NR > 1 { printf " %s |", $3 == "-0.0" ? "0.0" : $3 }')"
    frame=$((frame + 1))
  done <joints.csv
} | tee volume.md

say "5. Pictures: elbow and knee bent by 120 degrees, shoulder, wrist twisted by 150 degrees"
"$bin/krok-cam" -q -o cameras.cam -- "$story/cameras.json"
frame=0
for picture in elbow knee shoulder twist; do
  files=(linear.glb corrected.glb)
  size=560x280
  [ "$picture" != twist ] || { files=(linear.glb twist4.glb corrected.glb) && size=720x240; }
  "$bin/krok-render" -q --cam cameras.cam --from "${frame}s" --no-labels --size "$size" \
    -o "$picture.png" -- "${files[@]}"
  frame=$((frame + 1))
done
echo "  elbow.png knee.png shoulder.png twist.png"

say "Done. rig.glb has the correctives as morph targets with a weight at each frame."
