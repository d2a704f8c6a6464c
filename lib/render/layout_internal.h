#pragma once

#include <vector>

#include "render/sheet.h"

// The layout of a sheet.

namespace krok::render {

// Lengths in pixels.
inline constexpr int kMargin = 16;
inline constexpr int kGutter = 46;  // left of the cells, for height labels
inline constexpr int kHeader = 24;  // above a row's cells
inline constexpr int kLabel = 17;   // a line below a cell
inline constexpr int kRowGap = 12;
inline constexpr int kAir = 8;         // padding around the characters in a cell
inline constexpr int kGroundBand = 9;  // below the ground
inline constexpr int kKey = 46;
inline constexpr double kTitleSize = 14, kTextSize = 12, kSmallSize = 11;

// Colours that sheets and films share.
inline constexpr Colour kPaper = colour(0xFFFFFF);
inline constexpr Colour kPanel = colour(0xF4F5F7);
inline constexpr Colour kGround = colour(0xD5DAE0);
inline constexpr Colour kGroundLine = colour(0x5B6570);
inline constexpr Colour kInk = colour(0x1B1F24);
inline constexpr Colour kSoft = colour(0x5B6570);

// Above this elevation the ground is drawn as a grid.
inline constexpr double kRaised = 2 * kRadiansPerDegree;

struct RowLayout {
  int header = 0;           // top edge of its title
  int left = 0, right = 0;  // of its cells
  int top = 0, bottom = 0;  // of its cells
  double ground = 0;        // pixel row of y = 0 at the cells' centres
  bool shows_ground = true;
  double ground_distance = 0;  // metres from the characters down (or, negative, up) to the ground
  bool has_labels = false, has_notes = false;
  double low = 0, high = 0;  // height range of its cells, metres above the ground
};

struct Layout {
  int width = 0, height = 0;
  double pixels_per_metre = 0;
  double height_step = 0;
  int cell_width = 0;
  std::vector<RowLayout> rows;
  std::vector<CellLayout> cells;
  int key_top = 0;
};

// Codes sheet-empty, sheet-size.
Result<Layout> lay_out(const Sheet& sheet, const SheetOptions& options);

// The smallest 1, 2 or 5 times a power of ten that is at least `least`, which is positive.
double round_step(double least);

}  // namespace krok::render
