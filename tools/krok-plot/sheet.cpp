#include "tools/krok-plot/sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "core/numbers.h"
#include "core/parallel.h"
#include "render/sheet.h"
#include "tools/shared/shown_ground.h"

namespace krok::cli::plot {

namespace {

constexpr int kSheetMoments = 8;
// A sheet of many has half as many moments, and one view between the usual two.
constexpr std::size_t kMany = 12;
constexpr int kMomentsOfMany = 4;
constexpr int kStripMoments = 10;
constexpr int kStripWidth = 2400;
constexpr int kPathPoints = 400;

// A character at the times shown.
struct Shown {
  const MovingActor* source = nullptr;
  ImageSpan span;
  std::vector<ImageMoment> moments;
  std::vector<render::Actor> actors;  // [moments]
};

Result<Shown> show(const MovingActor& source, const SheetOptions& options,
                   const SheetGround& ground, int moments, int jobs) {
  Shown shown;
  shown.source = &source;
  const auto span = span_of(source, options.from, options.to);
  if (!span) return span.error();
  shown.span = *span;
  auto chosen = choose_moments(options.image.moments, moments, *span);
  if (!chosen) return std::move(chosen).error().in_file(source.path);
  shown.moments = std::move(*chosen);
  shown.actors.resize(shown.moments.size());
  parallel_for(shown.moments.size(), 1, jobs, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double time = shown.moments[i].time;
      shown.actors[i] = shown.source->at(time);
      if (ground.terrain == nullptr) continue;
      const GroundPart part = options.whole_ground ? part_below_way(source, shown.span)
                                                   : part_below(source.carrier(time));
      for (render::Surface& surface : ground_surfaces(*ground.terrain, ground.prints, part)) {
        shown.actors[i].surfaces.push_back(std::move(surface));
      }
      if (options.whole_ground) {
        const Vec2 middle = (part.low + part.high) / 2;
        shown.actors[i].centre = {middle.x(), 0, middle.y()};
      }
    }
  });
  return shown;
}

using ShownActors = std::vector<Shown>;

Result<ShownActors> show_all(const std::vector<MovingActor>& actors, const SheetOptions& options,
                             const SheetGround& ground, int moments, int jobs) {
  ShownActors all;
  for (const MovingActor& actor : actors) {
    auto shown = show(actor, options, ground, moments, jobs);
    if (!shown) return shown.error();
    all.push_back(std::move(*shown));
  }
  return all;
}

double front_of(const Shown& shown, const SheetOptions& options) {
  return options.front == Front::world ? 0.0 : shown.source->heading(shown.moments[0].time);
}

render::Sheet contact_sheet(const ShownActors& all, const std::vector<ImageSide>& sides,
                            const SheetOptions& options) {
  render::Sheet sheet;
  for (const Shown& shown : all) {
    for (const ImageSide& side : sides) {
      render::SheetRow row;
      row.title = shown.source->name;
      row.note = fmt::format("{}   {}", side.name, shown.source->facts);
      row.yaw = front_of(shown, options) + side.yaw;
      row.elevation = side.elevation;
      row.own_ground = !options.ground.empty();
      for (std::size_t i = 0; i < shown.moments.size(); ++i) {
        render::SheetCell cell;
        cell.layers = {{&shown.actors[i]}};
        cell.centre = shown.actors[i].centre;
        if (shown.source->duration > 0) {
          cell.label = shown.moments[i].label();
          cell.note = shown.moments[i].note();
        }
        row.cells.push_back(std::move(cell));
      }
      sheet.rows.push_back(std::move(row));
    }
  }
  return sheet;
}

// Rows of what is many times as large as most are at a smaller scale, and say so.
void keep_most_large(const ShownActors& all, render::Sheet& sheet) {
  constexpr std::size_t kFew = 5;
  constexpr double kMuchLarger = 3;
  std::vector<double> sizes;
  for (const Shown& shown : all) {
    double size = 0;
    for (const render::Actor& actor : shown.actors) {
      size = std::max(size, render::bounds(actor).extent());
    }
    sizes.push_back(size);
  }
  if (sizes.size() < kFew) return;
  std::vector<double> sorted = sizes;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  for (std::size_t r = 0; r < sheet.rows.size(); ++r) {
    const double times = sizes[r * sizes.size() / sheet.rows.size()] / *middle;
    if (!(times > kMuchLarger) || !std::isfinite(times)) continue;
    const double smaller = std::ceil(times / kMuchLarger);
    sheet.rows[r].scale = 1 / smaller;
    sheet.rows[r].note += fmt::format("   1/{} of the others' scale", readable(smaller));
  }
}

// The view direction of a strip: from the side, moving left to right, if the character travels;
// otherwise from its front. An explicit --view takes precedence.
ImageSide strip_side(const Shown& shown, const std::vector<ImageSide>& sides,
                     const SheetOptions& options) {
  ImageSide side = sides[0];
  side.yaw += front_of(shown, options);
  if (!are_usual_sides(options.image.sides)) return side;
  const Vec3 way = shown.actors.back().centre - shown.actors.front().centre;
  const render::Bounds box = render::bounds(shown.actors.front());
  if (way.norm() > 0.3 * box.extent()) {
    side.yaw = std::atan2(-way.z(), way.x());
    side.name = "moving right";
  }
  return side;
}

// The path of the hips over the whole range.
std::vector<Vec3> path_of(const Shown& shown) {
  std::vector<Vec3> path;
  for (int i = 0; i <= kPathPoints; ++i) {
    const double share = static_cast<double>(i) / kPathPoints;
    const double time = shown.span.start + share * (shown.span.end - shown.span.start);
    path.push_back(shown.source->carrier(time));
  }
  return path;
}

Json report_of(const render::SheetImage& image, const ShownActors& all, std::size_t rows_of_each) {
  Json json;
  json["width"] = image.image.width;
  json["height"] = image.image.height;
  json["pixels_per_metre"] = image.pixels_per_metre;
  json["height_step"] = image.height_step;
  json["cells"] = Json::array();
  for (const render::CellLayout& place : image.cells) {
    const Shown& shown = all[static_cast<std::size_t>(place.row) / rows_of_each];
    Json cell = to_json(place);
    cell["name"] = shown.source->name;
    Json moments = Json::array();
    const auto add = [&moments](const ImageMoment& moment) {
      Json one = {{"time", moment.time}};
      if (moment.frame >= 0) one["frame"] = moment.frame;
      moments.push_back(std::move(one));
    };
    if (rows_of_each == 0 || image.cells.size() == all.size()) {
      for (const ImageMoment& moment : shown.moments) add(moment);
    } else {
      add(shown.moments[static_cast<std::size_t>(place.column)]);
    }
    cell["moments"] = std::move(moments);
    json["cells"].push_back(std::move(cell));
  }
  return json;
}

// Where images go.
struct Results {
  ToolContext& context;
  OutputSet& outputs;
  std::vector<std::string>& done;
};

Status write(const render::Sheet& sheet, const render::SheetOptions& options,
             const std::string& path, const ShownActors& all, Results& results, const char* name) {
  const auto image = render::make_sheet(sheet, options);
  if (!image) return image.error();
  if (Status status = add_image(image->image, path, results.outputs); !status) return status;
  results.context.report.result[name] = report_of(*image, all, sheet.rows.size() / all.size());
  results.done.push_back(fmt::format("{}: {} x {} pixels, {} per metre", path, image->image.width,
                                     image->image.height, readable(image->pixels_per_metre, 3)));
  return {};
}

constexpr int kSmallest = 64;   // pixels: of actors on a sheet of many
constexpr int kReadable = 128;  // pixels: of actors where the sheet would be larger than a page
constexpr int kPage = 4000;     // pixels: height of a page

// Rows side by side: one for a few, then as many as make the sheet about as high as wide.
int usual_columns(const render::Sheet& sheet) {
  constexpr std::size_t kFew = 12;
  constexpr double kCell = 0.6;  // width of a standing person's cell, of its height
  if (sheet.rows.size() <= kFew) return 1;
  std::size_t cells = 1;
  for (const render::SheetRow& row : sheet.rows) cells = std::max(cells, row.cells.size());
  const double wide = kCell * static_cast<double>(cells);
  return std::max(1, static_cast<int>(std::sqrt(static_cast<double>(sheet.rows.size()) / wide)));
}

Status make_sheet(const std::vector<MovingActor>& actors, const std::vector<ImageSide>& sides,
                  const SheetOptions& options, const SheetGround& ground, Results& results) {
  const bool many = actors.size() > kMany;
  const auto all = show_all(actors, options, ground, many ? kMomentsOfMany : kSheetMoments,
                            results.context.jobs);
  if (!all) return all.error();
  std::vector<ImageSide> seen = sides;
  if (many && are_usual_sides(options.image.sides)) {
    seen = {{"front-left", (sides.front().yaw + sides.back().yaw) / 2, sides.front().elevation}};
  }
  render::Sheet sheet = contact_sheet(*all, seen, options);
  keep_most_large(*all, sheet);
  sheet.columns = options.columns.value_or(usual_columns(sheet));
  render::SheetOptions how;
  how.jobs = results.context.jobs;
  int size = options.image.size;
  if (!options.size_given) {
    const int rows = std::max(1, static_cast<int>(sheet.rows.size()) / sheet.columns);
    size = std::min(size, std::max(kReadable, kPage / rows));
  }
  for (;; size = size * 4 / 5) {
    how.row_height = size;
    how.cell_width = 2 * size;
    Status status = write(sheet, how, options.sheet, *all, results, "sheet");
    const bool too_large = !status && status.error().code == "sheet-size";
    if (!too_large || options.size_given || size < kSmallest) return status;
  }
}

Status make_strip(const std::vector<MovingActor>& actors, const std::vector<ImageSide>& sides,
                  const SheetOptions& options, const SheetGround& ground, Results& results) {
  const auto all = show_all(actors, options, ground, kStripMoments, results.context.jobs);
  if (!all) return all.error();
  std::deque<render::StripCells> cells;
  render::Sheet sheet;
  for (const Shown& shown : *all) {
    const ImageSide side = strip_side(shown, sides, options);
    render::Strip strip;
    strip.title = shown.source->name;
    strip.yaw = side.yaw;
    strip.elevation = side.elevation;
    strip.path = path_of(shown);
    for (std::size_t i = 0; i < shown.moments.size(); ++i) {
      strip.moments.push_back({&shown.actors[i], fmt::format("{:.2f} s", shown.moments[i].time)});
    }
    cells.push_back(render::strip_row(strip, render::Spread::automatic));
    render::SheetRow row = cells.back().row;
    row.note = cells.back().spread_by_time ? side.name + ", side by side in time" : side.name;
    row.note += "   " + shown.source->facts;
    sheet.rows.push_back(std::move(row));
  }
  render::SheetOptions how;
  how.row_height = options.image.size;
  how.cell_width = std::max(kStripWidth, 2 * options.image.size);
  how.jobs = results.context.jobs;
  return write(sheet, how, options.strip, *all, results, "strip");
}

}  // namespace

void declare_sheet(CommandOptions& command, SheetOptions& options, GroundChoice& ground) {
  command.add("--sheet OUT.png", options.sheet, output({".png"}),
              "Contact sheet as PNG: characters at several times, in rows by file, animation and "
              "side (more than "
              "12 files: at four times, from the front left, unless --moments or --view say else); "
              "materials with base colours, textures (PNG, JPEG) and vertex colours, cut out where "
              "alpha is below their cutoff, or below one half for blended ones");
  command.add("--strip OUT.png", options.strip, output({".png"}),
              "Motion strip as PNG: a character at several times in one image, earlier ones "
              "fainter");
  add_ground_option(command, ground,
                    "Ground to show below each actor and in the charts path and feet, as for "
                    "krok-walk: a mesh, a height field, or stairs:rise=17cm,run=29cm, slope:12deg, "
                    "rough:seed=1,height=8cm");
  command.only_with({"--sheet", "--strip"});
  command
      .add_flag("--whole-ground", options.whole_ground,
                "Show the ground of the whole way in each image, seen from one place")
      .only_with("--ground");
  declare_image_options(command, options.image, kSheetMoments);
  command.add(
      "--front WHAT", options.front,
      choice<Front>({{"actor", Front::actor}, {"world", Front::world}}),
      "What counts as the front: the facing at the first time (actor), or +Z, the facing in "
      "the reference pose (world)",
      "actor");
  add_body_option(command, options.body, kShownBody);
  add_clip_option(command, options.clip, "all");
  add_skin_method(command, options.method, kShownMethod);
}

Status make_sheets(const std::vector<std::string>& inputs, const SheetOptions& options,
                   ToolContext& context, OutputSet& outputs, std::vector<std::string>& done) {
  Results results{context, outputs, done};
  const std::vector<ImageSide> sides = sides_seen(options.image);
  const auto actors = read_actors(inputs,
                                  {.body = options.body,
                                   .method = options.method,
                                   .clip = options.clip,
                                   .every_clip = true,
                                   .from = options.from,
                                   .to = options.to},
                                  context);
  if (!actors) return actors.error();
  const auto ground = open_sheet_ground(options.ground, options.prints, context);
  if (!ground) return ground.error();
  if (!options.sheet.empty()) {
    if (Status status = make_sheet(*actors, sides, options, *ground, results); !status) {
      return status;
    }
  }
  if (!options.strip.empty()) return make_strip(*actors, sides, options, *ground, results);
  return {};
}

}  // namespace krok::cli::plot
