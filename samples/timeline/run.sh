#!/usr/bin/env bash
# A story out of six motions: sets off, walks and waves, turns, limps, stops, looks aside, waves
# good-bye. README.md tells how.
#
#   run.sh [OUTPUT_FOLDER]
#
# Without an argument: out/timeline. The tools are found through $KROK_BIN or in build/bin, make-walk
# and make-gesture through $SAMPLES_BIN or in build/samples.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
bin=${KROK_BIN:-$here/../../build/bin}
samples=${SAMPLES_BIN:-$here/../../build/samples}

usage() { sed -n '2,8s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; }

fail() {
  echo "run.sh: error: $1" >&2
  [ $# -lt 2 ] || echo "  hint: $2" >&2
  exit 2
}

case "${1:-}" in -h | --help) usage && exit 0 ;; esac
[ $# -le 1 ] || fail "$# arguments, at most 1 is taken" "put names with spaces in quotes"
out=${1:-out/timeline}
for tool in mix cam body skin view plot; do
  [ -x "$bin/krok-$tool" ] || fail "no krok-$tool in $bin" "build with make, or set KROK_BIN"
done
for program in make-walk make-gesture; do
  [ -x "$samples/$program" ] || fail "no $program in $samples" "build with make, or set SAMPLES_BIN"
done
mkdir -p -- "$out" || fail "cannot make the folder $out"
cd -- "$out"

say() { printf '\n%s\n' "$1"; }

say "1. Six motions"
"$samples/make-walk" --steps 8 --from-standing -o standing.bvh
"$samples/make-walk" --steps 8 -o walk.bvh
"$samples/make-walk" --steps 6 --step-length 65cm --turn 15deg -o turn.bvh
"$samples/make-gesture" --kind wave --duration 3s -o wave.bvh
"$samples/make-gesture" --kind limp --side left --duration 1.1s -o limp.bvh
"$samples/make-gesture" --kind look --side left --duration 2.5s -o look.bvh

say "2. One motion, as the timeline tells"
cp -- "$here/timeline.json" .
"$bin/krok-mix" timeline.json -o story.anim --json=story.report.json

say "3. A body, and a camera that follows"
"$bin/krok-body" -q -o walker.model -- story.anim
"$bin/krok-cam" story.anim --follow hips -o story.cam
"$bin/krok-skin" -q walker.model story.anim --as rig -o story.glb
"$bin/krok-view" -q walker.model story.anim story.cam -o story.html

say "4. To look at"
"$bin/krok-plot" -q story.anim --strip story.png --moments 16 --sides left --size 200
"$bin/krok-plot" -q story.anim --sheet moments.png --sides front-left --size 170 \
  --moments 1.2s,3.6s,6.5s,10.9s,15s,19.5s,21.3s,23.5s
echo "  story.html, story.glb, story.png, moments.png"
