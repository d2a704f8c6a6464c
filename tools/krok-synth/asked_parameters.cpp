#include "tools/krok-synth/asked_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/csv/table.h"
#include "math/transform.h"
#include "motion/sample.h"
#include "parametric/bounds.h"
#include "timeline/mix.h"
#include "tools/cli/usage.h"

namespace krok::cli::synth {

namespace {

Result<double> parse_value(std::string_view text, std::string_view unit) {
  if (unit == "m") return parse_length(text);
  if (unit == "rad") return parse_angle(text);
  const auto time = parse_clip_time(text);
  if (!time) return time.error();
  if (time->in_frames) return Error("quantity-unit", "the unit cannot be frames", "use s or ms");
  return time->value;
}

// For messages: "length 0.45 to 0.8 m, turn -10 to 30 degrees".
std::string in_words(const std::vector<NamedParameter>& parameters) {
  std::string text;
  for (const NamedParameter& parameter : parameters) {
    const bool angle = parameter.unit == "rad";
    const double factor = angle ? 1 / kRadiansPerDegree : 1;
    text += fmt::format("{}{} {} to {} {}", text.empty() ? "" : ", ", parameter.name,
                        readable(parameter.least * factor, 3), readable(parameter.most * factor, 3),
                        angle ? "degrees" : parameter.unit);
  }
  return text;
}

Error misfit(std::string message, const std::vector<NamedParameter>& parameters) {
  return {"usage", std::move(message), "the library has the parameters " + in_words(parameters)};
}

// By name, or by what it measures.
std::optional<std::size_t> find(std::string_view name,
                                const std::vector<NamedParameter>& parameters) {
  for (std::size_t d = 0; d < parameters.size(); ++d) {
    if (parameters[d].name == name || parameters[d].measures == name) return d;
  }
  return std::nullopt;
}

}  // namespace

std::vector<NamedParameter> parameters_of(const steps::StepsFile& file) {
  const parametric::Library& library = file.library;
  const parametric::Bounds bounds = parametric::bounds_of(library);
  const std::vector<std::string> names = steps::parameter_names(file);
  std::vector<NamedParameter> parameters;
  for (std::size_t d = 0; d < library.parameters.size(); ++d) {
    NamedParameter parameter;
    parameter.measures = name_of(library.parameters[d], library.skeleton, library.keytimes);
    parameter.name = names[d];
    parameter.unit = unit_of(library.parameters[d]);
    parameter.least = bounds.lower[d];
    parameter.most = bounds.upper[d];
    for (const parametric::Example& example : library.examples) {
      parameter.mean += example.parameters[d] / static_cast<double>(library.examples.size());
    }
    parameters.push_back(std::move(parameter));
  }
  return parameters;
}

Result<std::vector<double>> parse_settings(const std::vector<std::string>& words,
                                           const std::vector<NamedParameter>& parameters,
                                           ToolContext& context) {
  std::vector<std::optional<double>> values(parameters.size());
  for (const std::string& word : words) {
    const std::size_t sign = word.rfind('=');
    if (sign == std::string::npos) {
      return misfit(fmt::format("--set: '{}' is not NAME=VALUE", shown(word)), parameters);
    }
    if (word.find('=') != sign) {
      return usage(fmt::format("--set: '{}' sets several parameters", shown(word)),
                   "repeat the option for each: --set length=70cm --set turn=15deg");
    }
    const auto d = find(word.substr(0, sign), parameters);
    if (!d) {
      return misfit(fmt::format("--set: unknown parameter '{}'", shown(word.substr(0, sign))),
                    parameters);
    }
    if (values[*d]) {
      return misfit(fmt::format("--set: {} is set twice", parameters[*d].name), parameters);
    }
    const auto value = parse_value(word.substr(sign + 1), parameters[*d].unit);
    if (!value) {
      return Error("usage", fmt::format("--set {}: {}", parameters[*d].name, value.error().message),
                   value.error().hint);
    }
    values[*d] = *value;
  }
  std::vector<double> point;
  for (std::size_t d = 0; d < values.size(); ++d) {
    point.push_back(values[d].value_or(parameters[d].mean));
    if (values[d]) continue;
    const bool angle = parameters[d].unit == "rad";
    context.log(fmt::format("{}: {} {}, the mean of the examples; --set {}= sets it",
                            parameters[d].name,
                            readable(point[d] / (angle ? kRadiansPerDegree : 1), 3),
                            angle ? "degrees" : parameters[d].unit, parameters[d].name));
  }
  return point;
}

Result<std::vector<std::vector<double>>> read_points(const std::string& path,
                                                     const std::vector<NamedParameter>& parameters,
                                                     ToolContext& context) {
  const auto file = context.open_input(path);
  if (!file) return file.error();
  const auto table = csv::Table::read(file->text(), path);
  if (!table) return table.error();
  std::vector<std::size_t> columns;
  std::vector<double> factors;
  for (const NamedParameter& parameter : parameters) {
    auto column = table->find(parameter.name);
    if (!column) return std::move(column).error().in_file(path);
    columns.push_back(*column);
    const std::string& unit = table->columns()[*column].unit;
    const auto factor = parse_value("1" + unit, parameter.unit);
    if (!factor) {
      return Error("synth-table", fmt::format("{}: {}", parameter.name, factor.error().message),
                   factor.error().hint)
          .in_file(path);
    }
    factors.push_back(*factor);
  }
  std::vector<std::vector<double>> points(table->row_count());
  for (std::size_t d = 0; d < parameters.size(); ++d) {
    const std::vector<std::string> texts = table->texts(columns[d]);
    for (std::size_t row = 0; row < points.size(); ++row) {
      // A cell may have a unit of its own: "14\u00B0", "34deg".
      const auto number = parse_finite(texts[row]);
      const Result<double> value = number ? Result<double>(*number * factors[d])
                                          : parse_value(texts[row], parameters[d].unit);
      if (!value) {
        Error error("synth-table",
                    fmt::format("row {}, {}: {}", row + 1, parameters[d].name,
                                texts[row].empty() ? "no value" : value.error().message),
                    value.error().hint);
        error.where = table->place(row, columns[d]);
        return error;
      }
      points[row].push_back(*value);
    }
  }
  return points;
}

Result<Sequence> in_sequence(const std::vector<SequencePart>& parts, double transition,
                             const RoleMap& roles, ToolContext& context) {
  timeline::Timeline timeline;
  std::vector<timeline::Source> sources;
  for (const SequencePart& part : parts) {
    timeline::BaseItem item;
    item.name = part.name;
    item.play.source = static_cast<int>(sources.size());
    item.change.kind = timeline::ChangeKind::inertial;
    item.change.duration = transition;
    timeline.base.push_back(std::move(item));
    sources.push_back({part.name, part.clip, part.keys, {}});
  }
  auto mixed = timeline::mix(timeline, sources, roles, {.jobs = context.jobs});
  if (!mixed) return std::move(mixed).error();
  for (const timeline::ChangeFacts& change : mixed->changes) {
    if (!change.pops()) continue;
    context.warn("synth-pop",
                 fmt::format("the character changes too fast from {} to {}, at {:.2f} s",
                             parts[static_cast<std::size_t>(change.item) - 1].name,
                             parts[static_cast<std::size_t>(change.item)].name, change.begin),
                 "use a longer --transition, or a motion that ends as the next one begins");
  }
  Sequence made{std::move(mixed->clip), std::move(mixed->keys), {}};
  for (const timeline::ItemFacts& item : mixed->items) made.starts.push_back(item.start);
  return made;
}

Result<MeasuredPoint> measured_point(const parametric::Library& library) {
  MeasuredPoint point;
  std::array<bool, 3> known = {};
  bool same = true;
  for (std::size_t d = 0; d < library.parameters.size(); ++d) {
    const parametric::Parameter& parameter = library.parameters[d];
    if (parameter.quantity != parametric::Quantity::joint) continue;
    same = same && (point.joint < 0 ||
                    (parameter.joint == point.joint && parameter.keytime == point.keytime));
    point.joint = parameter.joint;
    point.keytime = parameter.keytime;
    const auto direction = static_cast<std::size_t>(parameter.direction);
    known[direction] = true;
    point.parameters[direction] = d;
  }
  if (same && std::ranges::all_of(known, [](bool one) { return one; })) return point;
  return Error("synth-place", "the library does not measure where one joint is at one keytime",
               "--place needs parameters such as RightHand.across@touch, .up and .along");
}

PointMiss miss_of(const parametric::Library& library, const MeasuredPoint& point, const Clip& clip,
                  double time, const Vec3& place) {
  std::vector<Transform> pose(clip.skeleton.names.size()), scratch(3 * pose.size());
  sample(clip, time, pose, scratch);
  PointMiss miss;
  miss.at = pose[static_cast<std::size_t>(point.joint)].position;
  const Transform stance =
      parametric::print_at(library.foot(library.stance()), clip, time).to_world();
  const Vec3 change = stance.orientation.conjugate() * Vec3(place - miss.at);
  const double side = library.swing == FootSide::left ? 1 : -1;
  miss.change = {side * change.x(), change.y(), change.z()};
  return miss;
}

}  // namespace krok::cli::synth
