#!/usr/bin/env bash
# Golden files: characters that must not change unnoticed. README.md tells the same story.
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

# make_assets CUTOFF: what the build of a game would do, from two captures to two characters in out/.
make_assets() {
  rm -rf out && mkdir out
  "$bin/krok-body" -q --detail low -o out/walker.model -- walk.anim
  "$bin/krok-skin" -q --as rig -o out/walk.glb -- out/walker.model walk.anim
  "$bin/krok-edit" -q --filter butterworth --cutoff "$1" -o turn_filtered.anim -- turn.anim
  "$bin/krok-skin" -q --as rig -o out/turn.glb -- out/walker.model turn_filtered.anim
}

# differs NAME: compares, keeps what is said in NAME.txt and gives the exit code.
differs() {
  local code=0
  "$bin/krok-diff" golden out --tolerance 0.1mm --angle 0.5deg --keep-going --summary "$1.html" \
    >"$1.txt" || code=$?
  sed 's/^/  /' "$1.txt"
  return $code
}

say "1. Two walks become two characters, and these the golden files"
"$generators/make-walk" -q --steps 4 -o walk.bvh
"$generators/make-walk" -q --steps 4 --turn 20deg -o turn.bvh
for walk in walk turn; do "$bin/krok-import" -q -o $walk.anim -- $walk.bvh; done
make_assets 10Hz
"$bin/krok-diff" golden out --update 2>&1 | sed 's/^/  /'

say "2. The next build gives the same"
make_assets 10Hz
differs same || fail "the same build gave something else"

say "3. A change: the turn is filtered harder"
make_assets 3Hz
if differs changed; then fail "the change was not found"; fi

say "4. Where, and when"
"$bin/krok-diff" -q golden/turn.glb out/turn.glb --tolerance 0.1mm --angle 0.5deg \
  --heatmap turn_heat.glb --plot turn.svg --sheet turn.png --sides left --moments 4 --size 150 || true
echo "  turn_heat.glb   the character where it differs most, in colours"
echo "  turn.svg        how far apart over time"
echo "  turn.png        both at several moments"

say "5. It was meant: the golden files are updated, and the build passes"
"$bin/krok-diff" golden out --tolerance 0.1mm --angle 0.5deg --update 2>&1 >updated.txt |
  sed 's/^/  /'
differs same || fail "the update left a difference"

say "Done. Commit golden/ with the change that explains it."
