#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "render/camera.h"
#include "render/image.h"
#include "render/sheet.h"

// Frames of films: characters seen by one or several cameras at one time, with ground, shadows and
// labels, as in a contact sheet.

namespace krok::render {

// A part of the image with a camera of its own.
struct FilmView {
  std::string title;                     // in its upper left corner; may be empty
  std::vector<SheetCell::Layer> layers;  // as in a sheet
  Camera camera;             // place_of_target is relative to the view's upper left corner
  std::optional<Lens> lens;  // replaces the camera
  int left = 0, top = 0, right = 0, bottom = 0;  // pixels, right and bottom exclusive
  Vec3 grid_centre = Vec3::Zero();               // of the ground grid
  double grid_step = 0.5;                        // metres between its lines
  bool own_ground = false;  // the characters bring a ground: no grid, no shadows
};

struct FilmFrame {
  std::vector<FilmView> views;   // must not overlap
  std::string label;             // at the lower left, such as the time; may be empty
  std::optional<ColourKey> key;  // at the lower right
};

// Paints frames. Keeps what frames share; use one per thread.
class FilmPainter {
 public:
  // Codes: render-memory, text-font.
  static Result<FilmPainter> create();
  FilmPainter(FilmPainter&&) noexcept;
  FilmPainter& operator=(FilmPainter&&) noexcept;
  ~FilmPainter();

  // Pixels do not depend on `jobs` (threads, see parallel_for). Views must lie inside the image, of
  // at most 100 million pixels. Codes: those of check(Actor), render-memory.
  Result<Image> paint(const FilmFrame& frame, int width, int height, int jobs);

 private:
  struct State;
  explicit FilmPainter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// The rectangles of `count` views of equal size in an image, row by row from the upper left: one
// row for up to four, else about as many rows as columns. The last row may be shorter.
std::vector<Box> film_boxes(std::size_t count, int width, int height);

}  // namespace krok::render
