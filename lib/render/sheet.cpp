#include "render/sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/numbers.h"
#include "core/parallel.h"
#include "render/layout_internal.h"
#include "render/overlays_internal.h"
#include "render/renderer_internal.h"
#include "render/text.h"

namespace krok::render {

namespace {

constexpr Colour kHeightLine = colour(0xE2E6EA);
constexpr Colour kPath = colour(0x9AA5B1);
constexpr Colour kAccent = colour(0xC2251C);

Box box_of(const CellLayout& cell) {
  return {Vec2(cell.left, cell.top), Vec2(cell.right, cell.bottom)};
}

constexpr double kAfterTitle = 10;   // pixels
constexpr int kWidestHeader = 1200;  // pixels

std::string note_of(const SheetRow& row, const RowLayout& place) {
  if (place.shows_ground) return row.note;
  return fmt::format("{}{}the ground is {} m {}", row.note, row.note.empty() ? "" : "   ",
                     readable(std::abs(place.ground_distance), 3),
                     place.ground_distance > 0 ? "below" : "above");
}

// A sheet of few cells is as wide as its headers, so that they can be read.
void widen_for_headers(const Sheet& sheet, TextPainter& text, Layout& layout) {
  if (sheet.columns > 1) return;
  for (std::size_t r = 0; r < sheet.rows.size(); ++r) {
    const RowLayout& place = layout.rows[r];
    const double width = text.width(sheet.rows[r].title, kTitleSize) + kAfterTitle +
                         text.width(note_of(sheet.rows[r], place), kTextSize);
    const int whole = place.left + static_cast<int>(std::ceil(width)) + kMargin;
    layout.width = std::max(layout.width, std::min(whole, kWidestHeader));
  }
}

// Paints the 2D parts: background and text.
class SheetPainter {
 public:
  SheetPainter(const Sheet& sheet, const Layout& layout, TextPainter& text, Image& image)
      : sheet_(sheet), layout_(layout), text_(text), image_(image) {}

  void paint_behind() {
    for (std::size_t r = 0; r < sheet_.rows.size(); ++r) {
      if (!sheet_.rows[r].cells.empty()) paint_row(sheet_.rows[r], layout_.rows[r]);
    }
    for (const CellLayout& cell : layout_.cells) {
      const SheetRow& row = sheet_.rows[static_cast<std::size_t>(cell.row)];
      if (row.elevation > kRaised && !row.own_ground) {
        paint_grid(cell, layout_.height_step / row.scale);
      }
      paint_path(content(cell).path, cell);
    }
  }

  // What is drawn over the actors.
  void paint_words() {
    for (const CellLayout& cell : layout_.cells) {
      const bool raised = sheet_.rows[static_cast<std::size_t>(cell.row)].elevation > kRaised;
      // Separates grounds seen from above.
      if (raised && cell.column > 0) {
        fill(image_, {{cell.left - 1.0, cell.top}, {cell.left + 1.0, cell.bottom}}, kPaper);
      }
    }
    for (std::size_t r = 0; r < sheet_.rows.size(); ++r) {
      paint_header(sheet_.rows[r], layout_.rows[r]);
    }
    for (const CellLayout& cell : layout_.cells) paint_labels(cell);
    if (sheet_.key) paint_key(*sheet_.key);
  }

 private:
  const SheetCell& content(const CellLayout& cell) const {
    return sheet_.rows[static_cast<std::size_t>(cell.row)]
        .cells[static_cast<std::size_t>(cell.column)];
  }

  void paint_row(const SheetRow& row, const RowLayout& place) {
    const double left = place.left, right = place.right;
    fill(image_, {{left, place.top}, {right, place.bottom}}, kPanel);
    if (row.elevation > kRaised) return;
    const double step = layout_.height_step;
    const auto first = static_cast<long long>(std::ceil(place.low / step));
    const auto last = static_cast<long long>(std::floor(place.high / step));
    for (long long i = first; i <= last; ++i) {
      const double height = static_cast<double>(i) * step;
      const double y = std::round(place.ground - height * layout_.pixels_per_metre);
      if (y < place.top + 5 || y > place.bottom - 4) continue;
      if (i != 0) fill(image_, {{left, y}, {right, y + 1}}, kHeightLine);
      const std::string words = i == 0 ? "0" : readable(height / row.scale) + " m";
      text_.draw(image_, {left - 6, y + 4}, words, kSmallSize, kSoft, Align::right);
    }
    if (!place.shows_ground) return;
    fill(image_, {{left, place.ground}, {right, place.bottom}}, kGround);
    fill(image_, {{left, place.ground}, {right, place.ground + 1.5}}, kGroundLine);
  }

  // A ground grid with the spacing of the height lines.
  void paint_grid(const CellLayout& cell, double step) {
    View view;
    view.camera = cell.camera;
    const double reach =
        std::hypot(cell.right - cell.left, cell.bottom - cell.top) / cell.camera.pixels_per_metre;
    render::paint_grid(Projection(view), {cell.camera.target, step, reach, 24}, box_of(cell),
                       image_);
  }

  void paint_path(const std::vector<Vec3>& path, const CellLayout& cell) {
    // In steps, because overlapping line pieces would be darker.
    constexpr double kStep = 4;
    std::vector<Vec2> line;
    for (const Vec3& point : path) {
      const Vec2 at = cell.camera.project(point);
      if (line.empty() || !((at - line.back()).norm() < kStep)) line.push_back(at);
    }
    for (std::size_t i = 1; i < line.size(); ++i) {
      draw_line(image_, line[i - 1], line[i], 1.5, kPath, box_of(cell));
    }
  }

  void paint_header(const SheetRow& row, const RowLayout& place) {
    const double line = place.header + 16;
    // A title alone may be wider than its cells.
    const double right = sheet_.columns == 1 ? layout_.width - kMargin : place.right;
    double x = place.left;
    const double size = text_.width(row.title, kTitleSize) > right - x ? kSmallSize : kTitleSize;
    const std::string title = text_.fitted(row.title, size, right - x);
    text_.draw(image_, {x, line}, title, size, kInk);
    x += text_.width(title, size) + (title.empty() ? 0 : kAfterTitle);
    text_.draw(image_, {x, line}, text_.fitted(note_of(row, place), kTextSize, right - x),
               kTextSize, kSoft);
  }

  void paint_labels(const CellLayout& cell) {
    const SheetCell& what = content(cell);
    const double middle = 0.5 * (cell.left + cell.right);
    const double most = cell.right - cell.left - 4;
    double line = cell.bottom + 13;
    text_.draw(image_, {middle, line}, text_.fitted(what.label, kTextSize, most), kTextSize,
               what.marked ? kAccent : kInk, Align::centre);
    std::vector<std::pair<double, double>> taken;  // marks that would overlap another are left out
    for (const SheetCell::Mark& mark : what.marks) {
      const double x = cell.camera.project(mark.at).x();
      const double half = 0.5 * text_.width(mark.text, kSmallSize) + 3;
      const bool free = std::none_of(taken.begin(), taken.end(), [&](const auto& other) {
        return x - half < other.second && other.first < x + half;
      });
      if (!free) continue;
      taken.emplace_back(x - half, x + half);
      text_.draw(image_, {x, line}, mark.text, kSmallSize, kSoft, Align::centre);
    }
    if (!what.label.empty() || !what.marks.empty()) line += kLabel;
    text_.draw(image_, {middle, line}, text_.fitted(what.note, kSmallSize, most), kSmallSize, kSoft,
               Align::centre);
  }

  void paint_key(const ColourKey& key) {
    const double left = kMargin + kGutter;
    const double width = std::min(320.0, static_cast<double>(layout_.width) - left - kMargin);
    paint_colour_key(key, {left, static_cast<double>(layout_.key_top)}, width, text_, image_);
  }

  const Sheet& sheet_;
  const Layout& layout_;
  TextPainter& text_;
  Image& image_;
};

}  // namespace

Colour ColourKey::at(double value) const {
  constexpr Colour kSame = colour(0xB9C1C9);
  constexpr Colour kSmall = colour(0x2A78D6);
  constexpr Colour kMiddle = colour(0xE8C84A);
  constexpr Colour kLarge = colour(0xD03B3B);
  if (value <= low) return kSame;
  const double share = value < high ? value / high : 1.0;  // NaN maps to 1 too
  return share < 0.5 ? mixed(kSmall, kMiddle, 2 * share) : mixed(kMiddle, kLarge, 2 * share - 1);
}

void paint_colour_key(const ColourKey& key, const Vec2& corner, double width, TextPainter& text,
                      Image& image) {
  const double left = corner.x(), top = corner.y() + 18;
  text.draw(image, {left, top - 6}, text.fitted(key.label, kTextSize, width), kTextSize, kInk);
  for (int i = 0; i < static_cast<int>(width); ++i) {
    const Colour at = key.at((i + 0.5) / width * key.high);
    fill(image, {{left + i, top}, {left + i + 1, top + 10}}, at);
  }
  const std::string end = fmt::format("{} {}", readable(key.high, 4), key.unit);
  text.draw(image, {left, top + 23}, "0", kSmallSize, kSoft);
  text.draw(image, {left + width, top + 23}, end, kSmallSize, kSoft, Align::right);
  if (key.low > 0 && key.low < key.high) {
    text.draw(image, {left + 0.5 * width, top + 23},
              fmt::format("grey: up to {} {}", readable(key.low, 4), key.unit), kSmallSize, kSoft,
              Align::centre);
  }
}

Result<SheetImage> make_sheet(const Sheet& sheet, const SheetOptions& options) {
  // Each actor once, however many cells show it.
  std::map<const Actor*, std::size_t> places;
  std::vector<const Actor*> actors;
  for (const SheetRow& row : sheet.rows) {
    for (const SheetCell& cell : row.cells) {
      for (const SheetCell::Layer& layer : cell.layers) {
        if (places.emplace(layer.actor, actors.size()).second) actors.push_back(layer.actor);
      }
    }
  }
  for (const Actor* actor : actors) {
    if (Status status = check(*actor); !status) return status.error();
  }
  // Before the work, so that a sheet that is too large costs little.
  auto layout = lay_out(sheet, options);
  if (!layout) return layout.error();
  auto text = TextPainter::create();
  if (!text) return text.error();
  widen_for_headers(sheet, *text, *layout);
  // A device of each thread's own: one prepares one actor at a time.
  std::vector<std::optional<Tracer>> tracers(slots_for(options.jobs));
  std::vector<std::optional<TracedActor>> made(tracers.size());
  std::vector<TracedActor> traced;
  traced.reserve(actors.size());
  const Status status = make_in_order(
      actors.size(), options.jobs,
      [&](std::size_t i, std::size_t slot) -> Status {
        if (!tracers[slot]) {
          auto tracer = Tracer::create();
          if (!tracer) return tracer.error();
          tracers[slot] = *std::move(tracer);
        }
        auto ready = tracers[slot]->add(*actors[i]);
        if (!ready) return ready.error();
        made[slot] = *std::move(ready);
        return {};
      },
      [&](std::size_t, std::size_t slot) -> Status {
        traced.push_back(*std::move(made[slot]));
        return {};
      });
  if (!status) return status.error();

  SheetImage image;
  image.image = Image(layout->width, layout->height, kPaper);
  SheetPainter painter(sheet, *layout, *text, image.image);
  painter.paint_behind();
  std::vector<View> views;
  for (const CellLayout& place : layout->cells) {
    const SheetRow& row = sheet.rows[static_cast<std::size_t>(place.row)];
    const SheetCell& cell = row.cells[static_cast<std::size_t>(place.column)];
    View view;
    view.camera = place.camera;
    view.left = place.left;
    view.top = place.top;
    view.right = place.right;
    view.bottom = place.bottom;
    view.shadows = row.elevation > kRaised && !row.own_ground;
    for (const SheetCell::Layer& layer : cell.layers) {
      view.layers.push_back(
          {&traced[places.at(layer.actor)], static_cast<float>(layer.opacity), layer.behind});
    }
    views.push_back(std::move(view));
  }
  render(views, image.image, options.jobs);
  painter.paint_words();
  image.cells = std::move(layout->cells);
  image.pixels_per_metre = layout->pixels_per_metre;
  image.height_step = layout->height_step;
  return image;
}

namespace {

constexpr double kFirst = 0.35;  // opacity
constexpr double kApart = 0.62;  // of the widest actor's width
// If the mean spacing is less than this fraction of the width, actors overlap too much.
constexpr double kCrowded = 0.3;

// An actor's extent in the image.
struct Width {
  double low = 0, high = 0;
};

Width width_of(const Actor& actor, const Vec3& right) {
  Width width{1e300, -1e300};
  const auto add = [&](const Vec3f& point) {
    const double at = right.dot(point.cast<double>() - actor.centre);
    width.low = std::min(width.low, at);
    width.high = std::max(width.high, at);
  };
  for (const Surface& surface : actor.surfaces) {
    for (const Vec3f& point : surface.positions) add(point);
  }
  for (const Bone& bone : actor.bones) {
    add(bone.from);
    add(bone.to);
  }
  return width.low <= width.high ? width : Width{};
}

Actor moved(const Actor& actor, const Vec3& by) {
  Actor result = actor;
  const Vec3f way = by.cast<float>();
  for (Surface& surface : result.surfaces) {
    for (Vec3f& point : surface.positions) point += way;
  }
  for (Bone& bone : result.bones) {
    bone.from += way;
    bone.to += way;
  }
  result.centre += by;
  return result;
}

}  // namespace

StripCells strip_row(const Strip& strip, Spread spread) {
  StripCells result;
  result.row.title = strip.title;
  result.row.note = strip.note;
  result.row.yaw = strip.yaw;
  result.row.elevation = strip.elevation;
  SheetCell& cell = result.row.cells.emplace_back();
  const std::size_t count = strip.moments.size();
  if (count == 0) return result;

  const Vec3 right = Camera{Vec3::Zero(), strip.yaw, strip.elevation}.right();
  double width = 0;
  double low = right.dot(strip.moments[0].actor->centre);
  double high = low;
  for (const Strip::Moment& moment : strip.moments) {
    const Width own = width_of(*moment.actor, right);
    width = std::max(width, own.high - own.low);
    low = std::min(low, right.dot(moment.actor->centre));
    high = std::max(high, right.dot(moment.actor->centre));
  }
  const auto steps = static_cast<double>(count - 1);
  result.spread_by_time = spread == Spread::time || (spread == Spread::automatic && count > 1 &&
                                                     high - low < kCrowded * width * steps);

  const Vec3 start = strip.moments[0].actor->centre;
  if (result.spread_by_time) {
    for (std::size_t i = 0; i < count; ++i) {
      const Actor& actor = *strip.moments[i].actor;
      const Vec3 place = start + kApart * width * static_cast<double>(i) * right;
      result.moved.push_back(moved(actor, place - actor.centre));
    }
  } else {
    cell.path = strip.path;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Actor& actor = result.spread_by_time ? result.moved[i] : *strip.moments[i].actor;
    const double share = count > 1 ? static_cast<double>(i) / steps : 1.0;
    cell.layers.push_back({&actor, kFirst + (1 - kFirst) * share, false});
    cell.marks.push_back({actor.centre, strip.moments[i].label});
  }
  cell.centre = start;
  cell.centre.y() = 0;
  return result;
}

}  // namespace krok::render
