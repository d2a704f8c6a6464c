#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "render/actor.h"
#include "render/camera.h"
#include "render/image.h"

// Contact sheets: figures at several moments in rows and columns, all at one scale, with the
// ground, lines of equal height and labels. Made without a display or a graphics card; the same
// sheet gives the same pixels for any number of threads.

namespace krok::render {

// The colours that a quantity has from 0 to `high`; 0 and what lies up to `low` is grey.
struct ColourKey {
  std::string label;         // "distance"
  std::string unit;          // "mm"
  double low = 0, high = 1;  // in that unit

  // Of a value in that unit; one that is not finite has the colour of `high`.
  Colour at(double value) const;
};

struct SheetCell {
  struct Layer {
    const Actor* actor = nullptr;
    double opacity = 1;   // of its silhouette, 0 .. 1
    bool behind = false;  // behind the others wherever it stands
  };
  // A word on the ground, such as a moment below one of several figures.
  struct Mark {
    Vec3 at = Vec3::Zero();
    std::string text;
  };
  std::vector<Layer> layers;   // several are seen in one another's place, the nearer before
  Vec3 centre = Vec3::Zero();  // what is in the middle: a point of the ground, y = 0
  std::string label, note;     // two lines below, the second fainter; may be empty
  bool marked = false;         // the label stands out
  std::vector<Mark> marks;
  std::vector<Vec3> path;  // a line behind the figures
};

struct SheetRow {
  std::string title, note;        // a line above; may be empty
  double yaw = 0, elevation = 0;  // where the camera looks from, see Camera
  std::vector<SheetCell> cells;
};

struct Sheet {
  std::vector<SheetRow> rows;
  std::optional<ColourKey> key;  // shown below
};

struct SheetOptions {
  // The tallest row's height and the widest cell's width, pixels: the scale is the largest at which
  // both hold. 32 .. 4000 and 32 .. 16000.
  int row_height = 280, cell_width = 560;
  int jobs = 0;  // threads, see parallel_for
};

// Where a cell is in the picture, and the camera that shows what is in it.
struct CellLayout {
  int row = 0, column = 0;
  Camera camera;
  int left = 0, top = 0, right = 0, bottom = 0;  // pixels, right and bottom beyond the last
};

struct SheetImage {
  Image image;
  std::vector<CellLayout> cells;  // row by row
  double pixels_per_metre = 0;    // of all cells
  double height_step = 0;         // metres from one line of equal height to the next
};

// With the camera level the ground is a line and heights can be read off; raised by more than two
// degrees it is a grid with the figures' shadows. A row whose figures are farther from the ground
// than they are large is shown without it, and says so. A cell without figures stays empty.
//
// Codes: sheet-empty for a sheet without a cell; sheet-size for options out of range or a picture
// of more than 100 million pixels or 30,000 in one direction; those of check(Figure).
Result<SheetImage> make_sheet(const Sheet& sheet, const SheetOptions& options = {});

}  // namespace krok::render
