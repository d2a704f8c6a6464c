#!/usr/bin/env bash
# Mesh regression testing with golden files. See README.md.
#
#   run.sh [OUTPUT_FOLDER]
#
# Without an argument: out/mesh_regression. The tools are found through $KROK_BIN or in build/bin,
# make-walk through $SAMPLES_BIN or in build/samples.
. "$(dirname "${BASH_SOURCE[0]}")/../story.sh"

check_arguments 1 "$@"
need_tools import edit body skin diff
need_generators make-walk
enter_folder "${1:-out/mesh_regression}"
rm -rf golden out

# make_assets CUTOFF: a game's asset build, from two captures to two characters in out/.
make_assets() {
  rm -rf out && mkdir out
  "$bin/krok-body" -q --detail low -o out/walker.model -- walk.anim
  "$bin/krok-skin" -q --as rig -o out/walk.glb -- out/walker.model walk.anim
  "$bin/krok-edit" -q --filter butterworth --cutoff "$1" -o turn_filtered.anim -- turn.anim
  "$bin/krok-skin" -q --as rig -o out/turn.glb -- out/walker.model turn_filtered.anim
}

# differs NAME: compares, writes the report to NAME.txt and returns the exit code.
differs() {
  local code=0
  "$bin/krok-diff" golden out --tolerance 0.1mm --angle 0.5deg --keep-going --summary "$1.html" \
    >"$1.txt" || code=$?
  sed 's/^/  /' "$1.txt"
  return $code
}

say "1. Make two characters and the golden files"
"$generators/make-walk" -q --steps 4 -o walk.bvh
"$generators/make-walk" -q --steps 4 --turn 20deg -o turn.bvh
for walk in walk turn; do "$bin/krok-import" -q -o $walk.anim -- $walk.bvh; done
make_assets 10Hz
"$bin/krok-diff" golden out --update 2>&1 | sed 's/^/  /'

say "2. An unchanged build passes"
make_assets 10Hz
differs same || fail "the same build gave a different result"

say "3. A change: the turn is filtered at a lower cutoff"
make_assets 3Hz
if differs changed; then fail "the change was not detected"; fi

say "4. Inspect the difference"
"$bin/krok-diff" -q golden/turn.glb out/turn.glb --tolerance 0.1mm --angle 0.5deg \
  --heatmap turn_heat.glb --plot turn.svg --sheet turn.png --view left --moments 4 --actor-size 150 || true
echo "  turn_heat.glb   heat map on the character at the largest difference"
echo "  turn.svg        difference over time"
echo "  turn.png        both at several moments"

say "5. Accept the change: update the golden files, and the build passes"
"$bin/krok-diff" golden out --tolerance 0.1mm --angle 0.5deg --update 2>&1 >updated.txt |
  sed 's/^/  /'
differs same || fail "the update left a difference"

say "Done. Commit golden/ with the change that explains it."
