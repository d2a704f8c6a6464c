#include "tools/krok-diff/difference_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/file.h"
#include "core/numbers.h"
#include "core/text.h"
#include "draw/difference_chart.h"
#include "formats/chart/chart_writer.h"
#include "render/image.h"
#include "roles/roles.h"
#include "tools/cli/output_set.h"

namespace krok::cli::diff {

namespace {

constexpr double kPale = 0.35;  // opacity of the first character where the difference is shown
constexpr render::Colour kPaleColour = render::colour(0x8E99A5);

struct LengthUnit {
  const char* name;
  double in_a_metre;
};

LengthUnit unit_for(double metres) {
  if (metres < 0.1) return {"mm", 1000};
  if (metres < 10) return {"cm", 100};
  return {"m", 1};
}

Result<std::vector<ImageMoment>> moments_of(const DifferenceSheet& sheet,
                                            const SheetOptions& options) {
  auto moments = choose_moments(options.image.moments, kDifferenceMoments, sheet.span);
  if (!moments || !sheet.worst) return moments;
  const auto at =
      std::lower_bound(moments->begin(), moments->end(), *sheet.worst,
                       [](const ImageMoment& a, const ImageMoment& b) { return a.time < b.time; });
  if (at == moments->end() || at->time != sheet.worst->time) moments->insert(at, *sheet.worst);
  return moments;
}

// The character in grey.
render::Actor in_grey(render::Actor actor) {
  for (render::Surface& surface : actor.surfaces) surface.colours = {kPaleColour};
  for (render::Bone& bone : actor.bones) bone.from_colour = bone.to_colour = kPaleColour;
  return actor;
}

// The note for the distances at one time.
std::string note_of(const DifferenceSheet& sheet, const Compared& one, bool worst,
                    const LengthUnit& unit) {
  if (!one.largest) return {};
  if (*one.largest <= sheet.tolerance) return "the same";
  return fmt::format("{} {} {}", worst ? "largest:" : "max",
                     readable(*one.largest * unit.in_a_metre, 3), unit.name);
}

// Adds the three rows of one view direction.
void add_rows(const DifferenceSheet& sheet, const ImageSide& side,
              const std::vector<ImageMoment>& moments, const std::vector<Compared>& compared,
              const std::vector<render::Actor>& pale, const LengthUnit& unit,
              render::Sheet& result) {
  render::SheetRow first, second, both;
  first.title = sheet.first_name;
  second.title = sheet.second_name;
  both.title = "difference";
  first.note = second.note = side.name;
  both.note = sheet.measured ? side.name + ", first faint"
                             : side.name +
                                   ", first faint; points do not correspond, so no "
                                   "distances are shown";
  for (render::SheetRow* row : {&first, &second, &both}) {
    row->yaw = sheet.heading + side.yaw;
    row->elevation = side.elevation;
  }
  const bool moves = moments.size() > 1 || sheet.span.end > sheet.span.start;
  for (std::size_t i = 0; i < moments.size(); ++i) {
    const Compared& one = compared[i];
    render::SheetCell cell;
    cell.centre = one.first.centre;  // the same for all three
    if (moves) cell.label = moments[i].label();
    cell.marked = sheet.worst && moments[i].time == sheet.worst->time;
    cell.layers = {{&one.first}};
    first.cells.push_back(cell);
    cell.layers = {{&one.second}};
    second.cells.push_back(cell);
    cell.layers = {{&pale[i], kPale, true}, {&one.coloured}};
    cell.note = note_of(sheet, one, cell.marked, unit);
    both.cells.push_back(std::move(cell));
  }
  for (render::SheetRow* row : {&first, &second, &both}) result.rows.push_back(std::move(*row));
}

// The pixels of a cell, as PNG in base64.
Result<std::string> encoded_cell(const render::Image& sheet, const render::CellLayout& cell) {
  render::Image part(cell.right - cell.left, cell.bottom - cell.top, {});
  for (int y = 0; y < part.height; ++y) {
    for (int x = 0; x < part.width; ++x) part.set(x, y, sheet.at(cell.left + x, cell.top + y));
  }
  const auto png = render::write_png(part);
  if (!png) return png.error();
  return to_base64(*png);
}

}  // namespace

DistanceColours distance_colours(double tolerance, double largest) {
  const LengthUnit unit = unit_for(largest);
  DistanceColours colours;
  render::ColourKey& key = colours.key;
  key.label = "distance";
  key.unit = unit.name;
  key.low = tolerance * unit.in_a_metre;
  key.high = largest * unit.in_a_metre;
  // A non-empty range even if the two are equal.
  if (!(key.high > key.low)) key.high = key.low > 0 ? 2 * key.low : 1;
  colours.in_a_metre = unit.in_a_metre;
  return colours;
}

Result<Pictures> make_pictures(const DifferenceSheet& sheet, int jobs) {
  constexpr int kHeight = 440, kMaxWidth = 640;  // pixels
  const bool frames = sheet.span.rate > 0;
  const ImageMoment moment =
      sheet.worst.value_or(ImageMoment{sheet.span.start, frames ? sheet.span.first : -1});
  const render::ColourKey key = distance_colours(sheet.tolerance, sheet.largest).key;
  const Compared compared = sheet.at(moment, key);
  const render::Actor pale = in_grey(compared.first);
  render::SheetRow row;
  row.yaw = sheet.heading + 0.25 * kPi;
  row.elevation = 10 * kRadiansPerDegree;
  render::SheetCell cell;
  cell.centre = compared.first.centre;
  for (const render::Actor* actor : {&compared.first, &compared.second}) {
    cell.layers = {{actor}};
    row.cells.push_back(cell);
  }
  cell.layers = {{&pale, kPale, true}, {&compared.coloured}};
  row.cells.push_back(std::move(cell));
  render::Sheet page;
  page.rows.push_back(std::move(row));
  const auto made = render::make_sheet(page, {kHeight, kMaxWidth, jobs});
  if (!made) return made.error();
  Pictures pictures;
  std::string* const texts[] = {&pictures.before, &pictures.after, &pictures.difference};
  for (std::size_t i = 0; i < std::size(texts); ++i) {
    auto text = encoded_cell(made->image, made->cells[i]);
    if (!text) return text.error();
    *texts[i] = *std::move(text);
  }
  pictures.width = made->cells[0].right - made->cells[0].left;
  pictures.height = made->cells[0].bottom - made->cells[0].top;
  if (sheet.span.end > sheet.span.start) {
    pictures.moment = moment.label() + (moment.note().empty() ? "" : ", " + moment.note());
  }
  if (sheet.measured) pictures.key = key;
  return pictures;
}

Status write_sheet(const DifferenceSheet& sheet, const SheetOptions& options,
                   ToolContext& context) {
  const auto moments = moments_of(sheet, options);
  if (!moments) return moments.error();
  const LengthUnit unit = unit_for(sheet.largest);
  const render::ColourKey key = distance_colours(sheet.tolerance, sheet.largest).key;
  std::vector<Compared> compared;
  compared.reserve(moments->size());
  for (const ImageMoment& moment : *moments) compared.push_back(sheet.at(moment, key));

  std::vector<render::Actor> pale;
  pale.reserve(compared.size());
  for (const Compared& one : compared) pale.push_back(in_grey(one.first));
  render::Sheet image;
  if (sheet.measured) image.key = key;
  for (const ImageSide& side : sides_seen(options.image)) {
    add_rows(sheet, side, *moments, compared, pale, unit, image);
  }
  render::SheetOptions how;
  how.row_height = options.image.size;
  how.cell_width = 2 * options.image.size;
  how.jobs = context.jobs;
  const auto made = render::make_sheet(image, how);
  if (!made) return made.error();
  OutputSet outputs(context);
  if (Status status = add_image(made->image, options.path, outputs); !status) return status;
  return outputs.finish();
}

namespace {

using draw::ChartedDifference;
using draw::Scale;

constexpr std::size_t kMaxAnimations = 8;

Result<Plot> finished(const draw::Chart& chart, std::size_t left_out) {
  auto svg = draw::to_svg(chart);
  if (!svg) return svg.error();
  return Plot{*std::move(svg), left_out};
}

// Adds the tolerance and the time of the max.
void add_measure(const compare::Measure& measure, ChartedDifference& chart) {
  chart.tolerance = chart.is_angle ? measure.tolerance / kRadiansPerDegree : measure.tolerance;
  if (measure.largest > 0) chart.worst_moment = measure.where.time;
}

// A quantity compared between scenes.
struct Quantity {
  const char* title;
  const char* of;
  bool is_angle;
  compare::MomentValue compare::MomentDifference::*value;
  compare::Measure compare::SceneDifference::*measure;
};
constexpr Quantity kQuantities[] = {
    {"Distance between vertices", "vertices", false, &compare::MomentDifference::positions,
     &compare::SceneDifference::positions},
    {"Angle between normals", "vertices", true, &compare::MomentDifference::normals,
     &compare::SceneDifference::normals},
    {"Angle between tangents", "vertices", true, &compare::MomentDifference::tangents,
     &compare::SceneDifference::tangents},
    {"Distance between joints", "joints", false, &compare::MomentDifference::joint_positions,
     &compare::SceneDifference::joint_positions},
    {"Angle between joints", "joints", true, &compare::MomentDifference::joint_orientations,
     &compare::SceneDifference::joint_orientations},
};

using Moments = std::vector<const compare::MomentDifference*>;

ChartedDifference chart_of(const Quantity& quantity, const Moments& moments,
                           const compare::SceneDifference& found) {
  ChartedDifference chart;
  chart.title = quantity.title;
  chart.of = quantity.of;
  chart.is_angle = quantity.is_angle;
  const double unit = quantity.is_angle ? 1 / kRadiansPerDegree : 1;
  for (const compare::MomentDifference* moment : moments) {
    const compare::MomentValue& value = moment->*quantity.value;
    chart.times.push_back(moment->time);
    chart.largest.push_back(unit * static_cast<double>(value.largest));
    chart.rms.push_back(unit * static_cast<double>(value.rms));
  }
  const compare::Measure& measure = found.*quantity.measure;
  add_measure(measure, chart);
  // The overall max may be in another animation.
  if (std::max(0, measure.where.animation) != std::max(0, moments.front()->animation)) {
    chart.worst_moment.reset();
  }
  return chart;
}

bool differs(const Moments& moments, const compare::SceneDifference& found) {
  return std::any_of(moments.begin(), moments.end(), [&](const compare::MomentDifference* moment) {
    return std::any_of(std::begin(kQuantities), std::end(kQuantities), [&](const Quantity& one) {
      return static_cast<double>((moment->*one.value).largest) > (found.*one.measure).tolerance;
    });
  });
}

}  // namespace

Result<Plot> plot_of(const PlottedClip& first, const PlottedClip& second,
                     const compare::ClipDifference& found) {
  const RoleMap first_roles = find_roles(first.clip->skeleton);
  const RoleMap second_roles = find_roles(second.clip->skeleton);
  draw::ChartedMotion a{first.name, first.clip, &first_roles, {}, {}};
  draw::ChartedMotion b{second.name, second.clip, &second_roles, {}, {}};
  a.frames = {0, first.clip->frame_count() - 1};
  b.frames = {0, second.clip->frame_count() - 1};
  const auto difference = draw::difference_over_time(a, b, {});
  if (!difference) return Error("diff-plot", difference.error().message);
  draw::Chart chart;
  chart.title = fmt::format("{} and {}", first.name, second.name);
  auto [distances, angles] = draw::difference_charts(*difference);
  add_measure(found.positions, distances);
  add_measure(found.orientations, angles);
  for (const ChartedDifference* charted : {&distances, &angles}) {
    chart.panels.push_back(draw::difference_panel(*charted, Scale::linear));
  }
  return finished(chart, 0);
}

Result<Plot> plot_of(const PlottedScenes& scenes) {
  const compare::SceneDifference& found = *scenes.found;
  std::map<int, Moments> animations;
  for (const compare::MomentDifference& moment : found.moments) {
    if (moment.frame >= 0) animations[moment.animation].push_back(&moment);
  }
  if (animations.empty()) return Error("diff-plot", "the two have no animation in common");
  const bool any = std::any_of(animations.begin(), animations.end(),
                               [&](const auto& one) { return differs(one.second, found); });
  const bool several = animations.size() > 1;
  draw::Chart chart;
  chart.title = fmt::format("{} and {}", scenes.first_name, scenes.second_name);
  std::size_t drawn = 0, left = 0;
  for (const auto& [animation, moments] : animations) {
    if (several && any && !differs(moments, found)) continue;
    if (drawn == kMaxAnimations) {
      ++left;
      continue;
    }
    ++drawn;
    const auto place = static_cast<std::size_t>(std::max(0, animation));
    std::string name =
        place < scenes.first->animations.size() ? scenes.first->animations[place].name : "";
    if (name.empty()) name = fmt::format("animation {}", animation);
    for (const Quantity& quantity : kQuantities) {
      if ((found.*quantity.measure).count == 0) continue;
      ChartedDifference charted = chart_of(quantity, moments, found);
      if (several) charted.title = name + ": " + charted.title;
      chart.panels.push_back(draw::difference_panel(charted, Scale::linear));
    }
  }
  if (chart.panels.empty()) {
    return Error("diff-plot", "the two have neither meshes nor joints in common");
  }
  return finished(chart, left);
}

Status write_plot(const Result<Plot>& plot, const std::string& path, ToolContext& context) {
  if (!plot && plot.error().code != "diff-plot") return plot.error();
  if (!plot) {
    context.warn("diff-plot", fmt::format("{} is not drawn: {}", path, plot.error().message));
    return {};
  }
  if (plot->left_out > 0) {
    context.warn("diff-plot",
                 fmt::format("{} more animations that differ are not drawn", plot->left_out));
  }
  return write_output(context, path,
                      [&](OutputFile& file) { return chart::write(path, plot->svg, file); });
}

}  // namespace krok::cli::diff
