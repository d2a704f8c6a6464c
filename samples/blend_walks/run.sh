#!/usr/bin/env bash
# Blends two walks with and without time alignment and compares the foot skate. See README.md.
#
#   run.sh [OUTPUT_FOLDER]
#
# Without an argument: out/blend_walks. The tools are found through $KROK_BIN or in build/bin,
# make-walk through $SAMPLES_BIN or in build/samples.
. "$(dirname "${BASH_SOURCE[0]}")/../story.sh"

check_arguments 1 "$@"
need_tools import keys blend edit plot
need_generators make-walk
weights=(0 0.25 0.5 0.75 1)
enter_folder "${1:-out/blend_walks}"

other() { awk -v w="$1" 'BEGIN { print 1 - w }'; }

# slide MOTION: its foot skate in mm/s.
slide() {
  "$bin/krok-keys" -q --discard-edits --json=slide.json -- "$1" >slide.txt
  awk -F'[:,]' '/"slide_speed"/ { printf "%.1f", 1000 * $2 }' slide.json
  rm -f slide.json slide.txt
}

# strikes MOTION: name and time of each keytime, detected in the motion.
strikes() {
  "$bin/krok-keys" -q --discard-edits -- "$1" | awk '$2 == "s" && NF == 3 { print $3, $1 }'
}

say "1. Two walks: short slow steps and long quick ones"
"$generators/make-walk" -q --steps 8 --step-length 50cm -o slow.bvh
"$generators/make-walk" -q --steps 8 --step-length 85cm -o quick.bvh
for walk in slow quick; do
  "$bin/krok-import" -q -o $walk.anim -- $walk.bvh
  "$bin/krok-keys" -o $walk.keys.json -- $walk.anim 2>&1 | sed 's/^/  /'
done

say "2. Blend with equal weights: time-aligned, with planted feet, and without alignment"
"$bin/krok-blend" -q --warp pchip --match-root root -o warped.anim -- slow.anim:0.5 quick.anim:0.5
"$bin/krok-blend" -q --warp pchip -o stance.anim -- slow.anim:0.5 quick.anim:0.5
# Both trimmed to the shorter walk.
for walk in slow quick; do "$bin/krok-edit" -q --to 3.6s -o ${walk}_clock.anim -- $walk.anim; done
"$bin/krok-blend" -q --contacts none -o clock.anim -- slow_clock.anim:0.5 quick_clock.anim:0.5

say "3. Foot skate"
{
  echo "| blend | foot skate |"
  echo "|---|---|"
  echo "| in step (\`--match-root root\`) | $(slide warped.anim) mm/s |"
  echo "| in step, planted feet (default) | $(slide stance.anim) mm/s |"
  echo "| by the clock (\`--contacts none\`) | $(slide clock.anim) mm/s |"
} | tee slide.md

say "4. Gait events, in seconds"
# Times are relative to the first heel strike.
{
  echo "| keytime | slow | quick | mean | detected in the blend |"
  echo "|---|---|---|---|---|"
  paste -d' ' <(strikes slow.anim) <(strikes quick.anim) <(strikes warped.anim) |
    awk 'NR == 1 { slow = $2; quick = $4 }
         { printf "| `%s` | %.3f | %.3f | %.3f | %.3f |\n", $1, $2 - slow, $4 - quick,
           0.5 * ($2 - slow + $4 - quick), $6 }' | sed -n '2,7p'
} | tee strikes.md

say "5. Sweep over the weight"
echo "weight,blend,slide [mm/s]" >sweep.csv
sheet=()
for weight in "${weights[@]}"; do
  rest=$(other "$weight")
  "$bin/krok-blend" -q --match-root root -o "weight_$weight.anim" -- "slow.anim:$rest" "quick.anim:$weight"
  "$bin/krok-blend" -q --contacts none -o clocked.anim \
    -- "slow_clock.anim:$rest" "quick_clock.anim:$weight"
  echo "$weight,in step,$(slide "weight_$weight.anim")" >>sweep.csv
  echo "$weight,by the clock,$(slide clocked.anim)" >>sweep.csv
  sheet+=("weight_$weight.anim")
done
rm -f clocked.anim clocked.keys.json
"$bin/krok-plot" -q --x weight --by blend --draw both -o slide.svg \
  --title "Sliding feet over the weight of the quick walk" -- sweep.csv
"$bin/krok-plot" -q --sheet sweep.png --view left --moments 6 --actor-size 110 -- "${sheet[@]}"
echo "  slide.svg   foot skate over the weight"
echo "  sweep.png   the blends from weight 0 (top) to weight 1 (bottom)"

say "Done. Play the blends with krok-view warped.anim clock.anim -o blend.html"
