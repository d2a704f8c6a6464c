#pragma once

#include <string>
#include <vector>

#include "render/sheet.h"

// Motion strips: a character at several times in one image, at its position at each time; earlier
// ones are fainter.

namespace krok::render {

struct Strip {
  struct Moment {
    const Actor* actor = nullptr;  // must outlive the StripCells made from the strip
    std::string label;
  };
  std::string title, note;
  double yaw = 0, elevation = 0;  // direction to the camera, see Camera
  std::vector<Moment> moments;    // in time order
  std::vector<Vec3> path;         // a line to draw, such as the path of the hips
};

enum class Spread : unsigned char {
  automatic,  // `place` if the character travels far enough to be distinct, otherwise `time`
  place,      // at the position at each time
  time        // side by side from left to right
};

struct StripCells {
  SheetRow row;              // one cell
  std::vector<Actor> moved;  // actors at new positions; the row refers to them
  bool spread_by_time = false;
};

// A sheet row that shows the strip. Opacity rises from kFirst for the first actor to 1 for the
// last. Spread by time, actors are kApart of the widest one's width apart, in one line across the
// image, and no path is drawn.
StripCells strip_row(const Strip& strip, Spread spread);

}  // namespace krok::render
