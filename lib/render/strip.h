#pragma once

#include <string>
#include <vector>

#include "render/sheet.h"

// Motion strips: the figure at several moments in one picture, where it was at each of them, the
// earlier ones paler.

namespace krok::render {

struct Strip {
  struct Moment {
    const Actor* actor = nullptr;  // must outlive what is made of the strip
    std::string label;
  };
  std::string title, note;
  double yaw = 0, elevation = 0;  // where the camera looks from, see Camera
  std::vector<Moment> moments;    // in order of time
  std::vector<Vec3> path;         // a line to draw with them, such as the hips'
};

enum class Spread : unsigned char {
  automatic,  // as `place` where the figure moves on enough to be told apart, otherwise as `time`
  place,      // each figure where it was
  time        // side by side from left to right
};

struct StripCells {
  SheetRow row;              // one cell
  std::vector<Actor> moved;  // figures that stand elsewhere than in the strip; the row uses them
  bool spread_by_time = false;
};

// The row of a sheet that shows the strip. A figure shows with an opacity that rises from kFirst
// for the first to 1 for the last. Spread by time, each figure stands kApart of the widest one's
// width from the one before, in one line across the picture, and no path is drawn.
StripCells strip_row(const Strip& strip, Spread spread);

}  // namespace krok::render
