#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/index.h"
#include "render/layout_internal.h"

namespace krok::render {

namespace {

constexpr int kMaxPixelsAcross = 30'000;
constexpr double kMaxPixels = 100e6;
constexpr double kHeightLines = 44;  // min pixels between height lines

// The range that cells show, in metres to the right of and above their centres.
struct Window {
  Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity());
  Vec2 high = -low;

  bool empty() const { return !(low.x() <= high.x()); }
  void add(const Vec2& at) {
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  void add(const Window& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
};

// Projects world points to an image plane at one unit per metre, up positive.
class Plane {
 public:
  Plane(const SheetRow& row, const Vec3& centre) : centre_(centre) {
    const Camera camera{centre, row.yaw, row.elevation};
    right_ = camera.right();
    up_ = camera.up();
  }
  Vec2 at(const Vec3& point) const {
    return {right_.dot(point - centre_), up_.dot(point - centre_)};
  }

 private:
  Vec3 centre_, right_, up_;
};

Window window_of(const SheetRow& row, const SheetCell& cell) {
  const Plane plane(row, cell.centre);
  Window window;
  const auto add_ball = [&](const Vec3f& middle, float radius) {
    const Vec2 at = plane.at(middle.cast<double>());
    const Vec2 reach = Vec2::Constant(static_cast<double>(radius));
    window.add(at - reach);
    window.add(at + reach);
  };
  for (const SheetCell::Layer& layer : cell.layers) {
    for (const Surface& surface : layer.actor->surfaces) {
      for (const Vec3f& point : surface.positions) window.add(plane.at(point.cast<double>()));
    }
    for (const Bone& bone : layer.actor->bones) {
      add_ball(bone.from, bone.from_radius);
      add_ball(bone.to, bone.to_radius);
    }
  }
  for (const Vec3& point : cell.path) window.add(plane.at(point));
  return window;
}

// A row's window, including the ground if it is near enough.
Window window_of(const SheetRow& row, RowLayout& place) {
  Window window;
  for (const SheetCell& cell : row.cells) {
    window.add(window_of(row, cell));
    place.has_labels = place.has_labels || !cell.label.empty() || !cell.marks.empty();
    place.has_notes = place.has_notes || !cell.note.empty();
  }
  if (window.empty()) return window;
  const double size = (window.high - window.low).maxCoeff();
  if (window.low.y() > size) {
    place.ground_distance = window.low.y();
  } else if (window.high.y() < -size) {
    place.ground_distance = window.high.y();
  }
  place.shows_ground = place.ground_distance == 0;
  if (place.shows_ground) {
    window.low.y() = std::min(window.low.y(), 0.0);
    window.high.y() = std::max(window.high.y(), 0.0);
  }
  return window;
}

Status check_options(const Sheet& sheet, const SheetOptions& options) {
  const auto has_cells = [](const SheetRow& row) { return !row.cells.empty(); };
  if (std::none_of(sheet.rows.begin(), sheet.rows.end(), has_cells)) {
    return Error("sheet-empty", "the sheet has no cells");
  }
  if (sheet.columns < 1) return Error("sheet-size", "a sheet has at least one column");
  if (options.row_height < 32 || options.row_height > 4000) {
    return Error("sheet-size", fmt::format("row height {} is out of range", options.row_height),
                 "expected 32 to 4000 pixels");
  }
  if (options.cell_width < 32 || options.cell_width > 16'000) {
    return Error("sheet-size", fmt::format("cell width {} is out of range", options.cell_width),
                 "expected 32 to 16000 pixels");
  }
  return {};
}

// What all rows show together, in metres at the sheet's scale.
struct Extent {
  std::vector<Window> rows;
  double left = std::numeric_limits<double>::infinity();  // of all windows, metres
  double right = -left;
  double height = 0;  // of the tallest window, metres
  std::size_t columns = 0;
};

Extent measure_rows(const Sheet& sheet, std::vector<RowLayout>& places) {
  Extent extent;
  for (std::size_t r = 0; r < sheet.rows.size(); ++r) {
    Window window = window_of(sheet.rows[r], places[r]);
    extent.columns = std::max(extent.columns, sheet.rows[r].cells.size());
    if (window.empty()) window.add(Vec2::Zero());
    window.low *= sheet.rows[r].scale;
    window.high *= sheet.rows[r].scale;
    extent.left = std::min(extent.left, window.low.x());
    extent.right = std::max(extent.right, window.high.x());
    extent.height = std::max(extent.height, window.high.y() - window.low.y());
    extent.rows.push_back(window);
  }
  return extent;
}

// One scale and cell width for all rows.
void choose_scale(const Extent& extent, const SheetOptions& options, Layout& layout) {
  Vec2 size(extent.right - extent.left, extent.height);
  const auto scale = [](int pixels, double metres) { return (pixels - 2 * kAir) / metres; };
  // A nominal size for characters of zero size, so that the scale is finite.
  size = size.cwiseMax(size.maxCoeff() > 0 ? 1e-3 * size.maxCoeff() : 1.0);
  layout.pixels_per_metre =
      std::min(scale(options.row_height, size.y()), scale(options.cell_width, size.x()));
  const double per_metre = layout.pixels_per_metre;
  layout.height_step = round_step(kHeightLines / per_metre);
  layout.cell_width = std::max(48, static_cast<int>(std::ceil(size.x() * per_metre)) + 2 * kAir);
}

Status check_image_size(double width, double height) {
  if (width > kMaxPixelsAcross || height > kMaxPixelsAcross || width * height > kMaxPixels) {
    return Error("sheet-size",
                 fmt::format("the image would be at least {:.0f} x {:.0f} pixels; "
                             "the limit is {} million pixels and {} in each direction",
                             width, height, static_cast<int>(kMaxPixels / 1e6), kMaxPixelsAcross),
                 "reduce the size or the number of times, sides or files");
  }
  return {};
}

// Places a row from `y` down; `height` is that of its window, in pixels.
void place_row(const SheetRow& row, const Window& window, double y, double height, double per_metre,
               RowLayout& place) {
  place.header = static_cast<int>(y);
  place.top = place.header + (row.title.empty() && row.note.empty() ? 0 : kHeader);
  place.bottom = static_cast<int>(place.top + std::ceil(height)) + 2 * kAir + kGroundBand;
  // On a pixel boundary, so that the line is sharp.
  place.ground = std::round(place.top + kAir + window.high.y() * per_metre);
  place.low = (place.ground - place.bottom) / per_metre;
  place.high = (place.ground - place.top) / per_metre;
}

// Rows side by side share a window, so that they stand on one line.
void join_windows(std::size_t columns, std::vector<Window>& rows) {
  for (std::size_t first = 0; first < rows.size(); first += columns) {
    const std::span<Window> side_by_side =
        std::span(rows).subspan(first, std::min(columns, rows.size() - first));
    Window all;
    for (const Window& window : side_by_side) all.add(window);
    std::ranges::fill(side_by_side, all);
  }
}

// Adds the cells of a placed row; `centre` is the middle of all windows, metres.
void add_cells(const SheetRow& row, std::size_t index, double centre, Layout& layout) {
  const RowLayout& place = layout.rows[index];
  const double per_metre = layout.pixels_per_metre;
  for (std::size_t c = 0; c < row.cells.size(); ++c) {
    CellLayout cell;
    cell.row = static_cast<int>(index);
    cell.column = static_cast<int>(c);
    cell.left = place.left + static_cast<int>(c) * layout.cell_width;
    cell.right = cell.left + layout.cell_width;
    cell.top = place.top;
    cell.bottom = place.bottom;
    const double middle = 0.5 * (cell.left + cell.right) - centre * per_metre;
    cell.camera = {row.cells[c].centre, row.yaw, row.elevation, per_metre * row.scale,
                   Vec2(middle, place.ground)};
    layout.cells.push_back(cell);
  }
}

}  // namespace

double round_step(double least) {
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least * (1 - 1e-9)) return factor * power;
  }
  return 10 * power;
}

Result<Layout> lay_out(const Sheet& sheet, const SheetOptions& options) {
  if (Status status = check_options(sheet, options); !status) return status.error();
  Layout layout;
  layout.rows.resize(sheet.rows.size());
  Extent extent = measure_rows(sheet, layout.rows);
  const std::size_t columns = std::min(at(sheet.columns), sheet.rows.size());
  join_windows(columns, extent.rows);
  choose_scale(extent, options, layout);

  const double cells_wide =
      static_cast<double>(extent.columns) * static_cast<double>(layout.cell_width);
  const double wide = 2.0 * kMargin + static_cast<double>(columns) * (kGutter + cells_wide);
  double y = kMargin, next = y;
  for (std::size_t r = 0; r < sheet.rows.size(); ++r) {
    const std::size_t column = r % columns;
    if (column == 0) y = next;
    RowLayout& place = layout.rows[r];
    const Window& window = extent.rows[r];
    const double high = (window.high.y() - window.low.y()) * layout.pixels_per_metre;
    const double bottom = y + kHeader + std::ceil(high) + 2 * kAir + kGroundBand;
    if (Status status = check_image_size(wide, bottom); !status) return status.error();
    place.left =
        static_cast<int>(kMargin + kGutter + static_cast<double>(column) * (kGutter + cells_wide));
    place.right = place.left + static_cast<int>(sheet.rows[r].cells.size()) * layout.cell_width;
    place_row(sheet.rows[r], window, y, high, layout.pixels_per_metre, place);
    add_cells(sheet.rows[r], r, 0.5 * (extent.left + extent.right), layout);
    const int labels = (place.has_labels ? kLabel : 0) + (place.has_notes ? kLabel : 0);
    next = std::max(next, static_cast<double>(place.bottom + labels + kRowGap));
  }
  y = next;
  layout.key_top = static_cast<int>(y);
  layout.width = static_cast<int>(wide);
  layout.height = layout.key_top + (sheet.key ? kKey : 0) + kMargin - kRowGap;
  return layout;
}

}  // namespace krok::render
