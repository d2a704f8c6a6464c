#!/usr/bin/env bash
# A walker is shoved, falls, gets up and walks on. See README.md.
#
#   run.sh [OUTPUT_FOLDER]
#
# Without an argument: out/fall. The tools are found through $KROK_BIN or in build/bin, make-walk and
# make-rise through $SAMPLES_BIN or in build/samples.
. "$(dirname "${BASH_SOURCE[0]}")/../story.sh"

check_arguments 1 "$@"
need_tools import ragdoll edit body skin plot view
need_generators make-walk make-rise
enter_folder "${1:-out/fall}"

say "1. A walk, one that begins from standing, and three motions of getting up"
"$generators/make-walk" -q --steps 6 -o walk.bvh
"$generators/make-walk" -q --steps 4 --from-standing -o on.bvh
for lying in front back side; do "$generators/make-rise" -q --from $lying -o $lying.bvh; done
"$bin/krok-import" -q walk.bvh on.bvh front.bvh back.bvh side.bvh --out-dir .

say "2. A shove, and up again over the side that is down"
"$bin/krok-ragdoll" walk.anim --at 1.2s --push Spine2=40Ns,0,-160Ns --duration 6s \
  --get-up front.anim --get-up back.anim --get-up side.anim --save-bodies walker.ragdoll.json \
  -o up.anim --json=up.json

say "3. The walk goes on"
"$bin/krok-edit" -q up.anim --append on.anim --blend 0s -o fall.anim

say "4. Six shoves from a table"
mkdir -p falls
cp -- "$story/pushes.csv" .
"$bin/krok-ragdoll" walk.anim --pushes pushes.csv --duration 5s -o 'falls/{name}.anim' --json=falls.json

say "5. Down stairs"
stairs=stairs:rise=-17cm,run=30cm,count=12,begin=20cm
"$generators/make-walk" -q --steps 10 --rise -17cm --step-length 30cm -o down.bvh
"$bin/krok-ragdoll" down.bvh --at 5.3s --push Spine2=10Ns,0,140Ns --duration 8s --ground $stairs \
  --get-up front.anim --get-up back.anim --get-up side.anim -o stairs_up.anim --json=stairs.json
"$bin/krok-edit" -q stairs_up.anim --append on.anim --blend 0s --match-height -o stairs.anim
"$bin/krok-plot" -q stairs.anim --ground $stairs --whole-ground --strip stairs.png --view left \
  --moments 5.3s,5.9s,6.4s,7s,9s,11s,13s,15s,17s --actor-size 200

say "6. A skinned walker, images and a page"
"$bin/krok-body" -q fall.anim -o walker.model
"$bin/krok-skin" -q walker.model fall.anim -o fall.glb --as rig
"$bin/krok-plot" -q fall.anim --sheet fall.png --moments 16 --view right --actor-size 200
"$bin/krok-view" -q fall.anim -o fall.html

say "7. Hard and soft ranges of motion"
for limits in hard soft; do
  options=(--at 1.2s --push "Spine2=40Ns,0,-160Ns")
  [ $limits = soft ] && options+=(--soft)
  "$bin/krok-ragdoll" -q walk.anim "${options[@]}" -o $limits.anim
done
"$bin/krok-plot" -q hard.anim soft.anim --show angles --from 1.1s --to 3s -o limits.svg

say "8. A fall from level ground, laid on a slope"
slope=slope:12deg,begin=-2m
"$bin/krok-edit" falls/left.anim --settle --ground $slope -o laid.anim --json=laid.json
"$bin/krok-plot" -q laid.anim --ground $slope --whole-ground --strip laid.png --view left \
  --moments 1.2s,1.7s,2.2s,3s,5s --actor-size 200
echo "  fall.glb, fall.html, fall.png, stairs.png, limits.svg, laid.png"
