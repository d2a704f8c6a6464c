#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "render/actor.h"
#include "render/camera.h"
#include "render/image.h"

// Contact sheets: characters at several times in rows and columns, all at one scale, with ground,
// height lines and labels. Rendered in software, without a display or a GPU; the pixels do not
// depend on the number of threads.

namespace krok::render {

// A colour scale from 0 to `high`; values up to `low` are grey.
struct ColourKey {
  std::string label;         // "distance"
  std::string unit;          // "mm"
  double low = 0, high = 1;  // in that unit

  // The colour of a value in that unit; values that are not finite get the colour of `high`.
  Colour at(double value) const;
};

struct SheetCell {
  struct Layer {
    const Actor* actor = nullptr;
    double opacity = 1;   // of the silhouette, 0 .. 1
    bool behind = false;  // drawn behind the others regardless of depth
  };
  // A label on the ground, such as the time below one of several characters.
  struct Mark {
    Vec3 at = Vec3::Zero();
    std::string text;
  };
  std::vector<Layer> layers;   // drawn at their world positions, sorted by depth
  Vec3 centre = Vec3::Zero();  // shown in the middle of the cell: a point of the ground, y = 0
  std::string label, note;     // two lines below the cell, the second fainter; may be empty
  bool marked = false;         // highlights the label
  std::vector<Mark> marks;
  std::vector<Vec3> path;  // a line behind the characters
};

struct SheetRow {
  std::string title, note;        // a line above; may be empty
  double yaw = 0, elevation = 0;  // direction to the camera, see Camera
  std::vector<SheetCell> cells;
  double scale = 1;         // times that of the sheet; smaller for what would make others tiny
  bool own_ground = false;  // the characters bring a ground: a raised camera shows no grid
};

struct Sheet {
  std::vector<SheetRow> rows;
  int columns = 1;               // rows side by side, at least 1; filled from left to right
  std::optional<ColourKey> key;  // shown below
};

struct SheetOptions {
  // Max row height and max cell width in pixels: the scale is the largest that satisfies both. 32
  // .. 4000 and 32 .. 16000.
  int row_height = 280, cell_width = 560;
  int jobs = 0;  // threads, see parallel_for
};

// A cell's position in the image, and its camera.
struct CellLayout {
  int row = 0, column = 0;
  Camera camera;
  int left = 0, top = 0, right = 0, bottom = 0;  // pixels, right and bottom exclusive
};

struct SheetImage {
  Image image;
  std::vector<CellLayout> cells;  // row by row
  double pixels_per_metre = 0;    // of all cells, but for their rows' scales
  double height_step = 0;         // metres between height lines
};

// With a level camera the ground is a line and heights can be measured; with a camera raised by
// more than two degrees it is a grid with shadows. Rows whose characters are farther from the
// ground than their size are shown without ground, with a note. A cell without actors stays empty.
//
// Codes: sheet-empty for a sheet without cells; sheet-size for options out of range or an image of
// more than 100 million pixels or more than 30,000 in one direction; those of check(Actor).
Result<SheetImage> make_sheet(const Sheet& sheet, const SheetOptions& options = {});

// Motion strips: a character at several times in one image, at its position at each time; earlier
// ones are fainter.

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
