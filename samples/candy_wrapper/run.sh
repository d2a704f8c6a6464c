#!/usr/bin/env bash
# The candy wrapper effect: volume loss of a twisted forearm by skinning method. See README.md.
#
#   run.sh [OUTPUT_FOLDER]
#
# Without an argument: out/candy_wrapper. The tools are found through $KROK_BIN or in build/bin,
# make-forearm through $SAMPLES_BIN or in build/samples.
. "$(dirname "${BASH_SOURCE[0]}")/../story.sh"

check_arguments 1 "$@"
need_tools skin info plot
need_generators make-forearm
methods=(linear dual-quaternion rigid)
enter_folder "${1:-out/candy_wrapper}"

# Volume between elbow and wrist, litres: a prism of 250 mm over a 96-gon inscribed in an ellipse
# with semi-axes of 35 and 45 mm.
stretch=$(awk 'BEGIN { print 0.25 * 0.035 * 0.045 * 48 * sin(3.141592653589793 / 48) * 1000 }')

# volume METHOD FRAME: volume of the mesh in litres.
volume() {
  "$bin/krok-skin" -q --as pose --method "$1" --time "$2f" -o pose.glb -- forearm.model \
    twist.anim &&
    "$bin/krok-info" --json -- pose.glb | awk -F'[:,]' '/"volume":/ { printf "%.9f", 1000 * $2 }'
}

say "1. A forearm and a 180-degree twist"
"$generators/make-forearm" -q --model forearm.model -o twist.anim
"$bin/krok-info" -- forearm.model | grep -E '^  (mesh|volume) '

say "2. Skin with each method"
for method in "${methods[@]}"; do
  "$bin/krok-skin" -q --as baked --method "$method" --every 45 -o "$method.glb" -- forearm.model twist.anim
done
"$bin/krok-plot" -q --sheet twist.png --view front --moments 0s,0.75s,1.5s,2.25s,3s --actor-size 150 \
  -- "${methods[@]/%/.glb}"
echo "  twist.png   twisted by 0, 45, 90, 135 and 180 degrees"

say "3. Volume loss between elbow and wrist"
# One degree per frame. Only this part loses volume: the rest of the arm moves rigidly.
whole=$(volume linear 0)
echo "twist [deg],method,volume lost [percent]" >volume.csv
for degrees in $(seq 0 15 180); do
  for method in "${methods[@]}"; do
    left=$(volume "$method" "$degrees")
    awk -v whole="$whole" -v left="$left" -v stretch="$stretch" -v place="$degrees,$method" \
      'BEGIN { tenths = 1000 * (whole - left) / stretch
               printf "%s,%.1f\n", place, int(tenths + 0.5) / 10 }'
  done
done >>volume.csv
rm -f pose.glb
"$bin/krok-plot" -q --x "twist" --by method --draw both -o volume.svg \
  --title "Volume lost between elbow and wrist" -- volume.csv
lost() { awk -F, -v at="$1" -v by="$2" '$1 == at && $2 == by { print $3 " %" }' volume.csv; }
{
  echo "| twist | linear | dual quaternion | rigid | (1 - cos twist) / 3 |"
  echo "|---|---|---|---|---|"
  for degrees in 45 90 135 180; do
    closed=$(awk -v a="$degrees" \
      'BEGIN { printf "%.1f %%", 100 * (1 - cos(a * 3.141592653589793 / 180)) / 3 }')
    echo "| $degrees° | $(lost $degrees linear) | $(lost $degrees dual-quaternion) |" \
      "$(lost $degrees rigid) | $closed |"
  done
} | tee volume.md

say "Done. Open linear.glb, dual-quaternion.glb and rigid.glb in any glTF viewer."
