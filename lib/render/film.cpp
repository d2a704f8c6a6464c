#include "render/film.h"

#include <algorithm>
#include <cmath>

#include "render/layout_internal.h"
#include "render/overlays_internal.h"
#include "render/renderer_internal.h"
#include "render/text.h"

namespace krok::render {

namespace {

constexpr double kLensReach = 14;  // metres of grid around the centre, seen through a lens

Box box_of(const FilmView& view) {
  return {Vec2(view.left, view.top), Vec2(view.right, view.bottom)};
}

View view_of(const FilmView& film) {
  View view;
  view.camera = film.camera;
  view.camera.place_of_target += Vec2(film.left, film.top);
  view.lens = film.lens;
  view.left = film.left;
  view.top = film.top;
  view.right = film.right;
  view.bottom = film.bottom;
  view.shadows = !film.own_ground && (film.lens || film.camera.elevation > kRaised);
  return view;
}

void paint_ground(const FilmView& film, const View& view, Image& image) {
  const Box box = box_of(film);
  fill(image, box, kPanel);
  if (film.own_ground) return;
  if (view.shadows) {
    const double reach = film.lens ? kLensReach
                                   : std::hypot(film.right - film.left, film.bottom - film.top) /
                                         film.camera.pixels_per_metre;
    const Grid grid{film.grid_centre, film.grid_step, reach, film.lens ? 96 : 24};
    paint_grid(Projection(view), grid, box, image);
    return;
  }
  const Vec2 line = view.camera.project({view.camera.target.x(), 0, view.camera.target.z()});
  const double y = std::clamp(std::round(line.y()), box.low.y(), box.high.y());
  fill(image, {{box.low.x(), y}, box.high}, kGround);
  fill(image, {{box.low.x(), y}, {box.high.x(), std::min(y + 1.5, box.high.y())}}, kGroundLine);
}

}  // namespace

struct FilmPainter::State {
  Tracer tracer;
  TextPainter text;

  void paint_words(const FilmFrame& frame, Image& image);
};

void FilmPainter::State::paint_words(const FilmFrame& frame, Image& image) {
  const double margin = std::clamp(0.02 * image.height, 5.0, 14.0);
  const double size = std::clamp(0.03 * image.height, 11.0, 20.0);
  for (const FilmView& view : frame.views) {
    const double wide = view.right - view.left - 2 * margin;
    text.draw(image, {view.left + margin, view.top + margin + 0.8 * size},
              text.fitted(view.title, size, wide), size, kInk);
    // Separates views.
    if (view.left > 0) {
      fill(image, {{view.left - 1.0, view.top}, {view.left + 1.0, view.bottom}}, kPaper);
    }
    if (view.top > 0) {
      fill(image, {{view.left, view.top - 1.0}, {view.right, view.top + 1.0}}, kPaper);
    }
  }
  const double line = image.height - margin - 0.2 * size;
  text.draw(image, {margin, line}, text.fitted(frame.label, size, image.width / 2.0), size, kSoft);
  if (!frame.key) return;
  const double wide = std::min(320.0, 0.35 * image.width);
  paint_colour_key(*frame.key, Vec2(image.width - margin - wide, image.height - margin - kKey),
                   wide, text, image);
}

FilmPainter::FilmPainter(std::unique_ptr<State> state) : state_(std::move(state)) {}
FilmPainter::FilmPainter(FilmPainter&&) noexcept = default;
FilmPainter& FilmPainter::operator=(FilmPainter&&) noexcept = default;
FilmPainter::~FilmPainter() = default;

Result<FilmPainter> FilmPainter::create() {
  auto tracer = Tracer::create();
  if (!tracer) return tracer.error();
  auto text = TextPainter::create();
  if (!text) return text.error();
  return FilmPainter(std::make_unique<State>(State{*std::move(tracer), *std::move(text)}));
}

Result<Image> FilmPainter::paint(const FilmFrame& frame, int width, int height, int jobs) {
  Image image(width, height, kPaper);
  std::vector<TracedActor> traced;
  std::size_t count = 0;
  for (const FilmView& view : frame.views) count += view.layers.size();
  traced.reserve(count);  // views point to them
  std::vector<View> views;
  for (const FilmView& film : frame.views) {
    View view = view_of(film);
    paint_ground(film, view, image);
    for (const SheetCell::Layer& layer : film.layers) {
      auto ready = state_->tracer.add(*layer.actor);
      if (!ready) return ready.error();
      traced.push_back(*std::move(ready));
      view.layers.push_back({&traced.back(), static_cast<float>(layer.opacity), layer.behind});
    }
    views.push_back(std::move(view));
  }
  render(views, image, jobs);
  state_->paint_words(frame, image);
  return image;
}

std::vector<Box> film_boxes(std::size_t count, int width, int height) {
  const std::size_t columns =
      count <= 4 ? std::max<std::size_t>(count, 1)
                 : static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  const std::size_t rows = (count + columns - 1) / columns;
  const auto edge = [](int length, std::size_t i, std::size_t of) {
    return std::floor(length * static_cast<double>(i) / static_cast<double>(of));
  };
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t row = i / columns, column = i % columns;
    boxes.push_back({Vec2(edge(width, column, columns), edge(height, row, rows)),
                     Vec2(edge(width, column + 1, columns), edge(height, row + 1, rows))});
  }
  return boxes;
}

}  // namespace krok::render
