#pragma once

namespace krok {

// What an animation does from one of its key times to the next, for comparing it there too.
struct KeyGap {
  // Equal parts at whose ends to look: 1 if the values are straight from key to key, more for
  // cubic splines and for rotations by large angles, whose shorter way depends on rounding.
  int parts = 1;
  bool jumps = false;  // a step: a value jumps at the end

  friend bool operator==(const KeyGap&, const KeyGap&) = default;
};

}  // namespace krok
