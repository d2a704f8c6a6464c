#include "tools/shared/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "core/file.h"
#include "core/numbers.h"
#include "core/text.h"
#include "render/image.h"

namespace krok::cli {

namespace {

constexpr int kMaxMoments = 200;

std::vector<std::string_view> parts(std::string_view text) {
  std::vector<std::string_view> result;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    result.push_back(trimmed(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  return result;
}

std::vector<ImageMoment> spread(int count, const ImageSpan& span) {
  std::vector<ImageMoment> moments;
  const auto add = [&](double share) {
    if (span.rate > 0) {
      const int frame = span.first + static_cast<int>(std::round(share * (span.last - span.first)));
      if (!moments.empty() && moments.back().frame == frame) return;
      moments.push_back({frame / span.rate, frame});
    } else {
      const double time = span.start + share * (span.end - span.start);
      if (!moments.empty() && moments.back().time == time) return;
      moments.push_back({time, -1});
    }
  };
  for (int i = 0; i < count; ++i) add(count > 1 ? static_cast<double>(i) / (count - 1) : 0.0);
  return moments;
}

Result<ImageMoment> parse_moment(std::string_view word, const ImageSpan& span) {
  const auto time = parse_clip_time(word);
  if (!time) {
    return Error("usage", fmt::format("--moments: {}", time.error().message),
                 "give a number of images, or times as in 0s,1.5s,120f");
  }
  constexpr double kTolerance = 1e-6;
  if (span.rate > 0) {
    const double frame = std::round(time->in_frames ? time->value : time->value * span.rate);
    if (!(frame >= span.first && frame <= span.last)) {
      return usage(
          fmt::format("--moments {}: not in the shown frames {} to {}, {} to {} s", written(*time),
                      span.first, span.last, readable(span.first / span.rate, 4),
                      readable(span.last / span.rate, 4)),
          frame_hint(*time, span.last + 1));
    }
    return ImageMoment{frame / span.rate, static_cast<int>(frame)};
  }
  if (time->in_frames) {
    return Error("usage", fmt::format("--moments {}: the file has no frames; give seconds", word));
  }
  if (!(time->value >= span.start - kTolerance && time->value <= span.end + kTolerance)) {
    return Error("usage", fmt::format("--moments {}: not in the shown range {} s to {} s", word,
                                      readable(span.start), readable(span.end)));
  }
  return ImageMoment{std::clamp(time->value, span.start, span.end), -1};
}

Error too_many() {
  return Error("usage", fmt::format("--moments: the number must be from 1 to {}", kMaxMoments));
}

const std::vector<ImageSide>& known_sides() {
  static const std::vector<ImageSide> sides = {
      {"front", 0, 0},
      {"left", 0.5 * kPi, 0},
      {"back", kPi, 0},
      {"right", -0.5 * kPi, 0},
      {"front-left", 0.25 * kPi, 0},
      {"front-right", -0.25 * kPi, 0},
      {"back-left", 0.75 * kPi, 0},
      {"back-right", -0.75 * kPi, 0},
      {"top", 0, 0.5 * kPi},
  };
  return sides;
}

std::vector<std::string> names_of_sides() {
  std::vector<std::string> names;
  for (const ImageSide& side : known_sides()) names.push_back(side.name);
  return names;
}

ValueKind<std::vector<ImageSide>> view_kind() {
  const auto read = [](const std::string& text) -> Result<std::vector<ImageSide>> {
    std::vector<ImageSide> sides;
    for (const std::string_view word : parts(text)) {
      const auto found = std::ranges::find(known_sides(), word, &ImageSide::name);
      if (found == known_sides().end()) {
        return usage(fmt::format("unknown side '{}'", shown(word)),
                     nearest_hint(word, names_of_sides()));
      }
      sides.push_back(*found);
    }
    if (sides.size() > known_sides().size()) return usage("too many sides");
    return sides;
  };
  return {"view", "LIST", read, {}};
}

constexpr const char* kUsualSides = "front,left";

}  // namespace

CommandOption add_sides_option(CommandOptions& command, std::vector<ImageSide>& sides,
                               const std::string& each, const std::string& preset) {
  return command.add("--view", sides, view_kind(),
                     fmt::format("View directions, one {} each: front, left, back, right, "
                                 "front-left, ..., top",
                                 each),
                     preset);
}
CommandOption add_elevation_option(CommandOptions& command, double& elevation,
                                   const std::string& help, const std::string& preset) {
  return command.add("--elevation", elevation, angle({-90, 90}), help, preset);
}

void declare_image_options(CommandOptions& command, ImageOptions& options, int by_default) {
  command.add_option(
      "--moments LIST", options.moments,
      fmt::format("Times to show: a number of evenly spaced times (default: {}), or a "
                  "list: 0s,1.5s,120f",
                  by_default));
  add_sides_option(command, options.sides, "row", kUsualSides);
  add_elevation_option(command, options.elevation,
                       "Camera elevation; at 0, heights can be measured; above, the ground is a "
                       "grid with shadows",
                       "0deg");
  command.add("--actor-size PIXELS", options.size, whole(32, 4000),
              "Max height of an actor in pixels: 32 to 4000", "280");
}

bool are_usual_sides(const std::vector<ImageSide>& sides) {
  const auto usual = view_kind().read(kUsualSides);
  return usual && *usual == sides;
}

std::vector<ImageSide> sides_seen(const ImageOptions& options) {
  std::vector<ImageSide> sides = options.sides;
  for (ImageSide& side : sides) {
    if (side.elevation == 0) side.elevation = options.elevation;
  }
  return sides;
}

std::string ImageMoment::label() const {
  return frame >= 0 ? fmt::format("frame {}", frame) : fmt::format("{:.2f} s", time);
}

std::string ImageMoment::note() const {
  return frame >= 0 ? fmt::format("{:.2f} s", time) : std::string();
}

Result<std::vector<ImageMoment>> choose_moments(const std::string& moments, int by_default,
                                                const ImageSpan& span) {
  if (moments.empty()) return spread(by_default, span);
  if (const auto count = parse_integer(moments)) {
    if (*count < 1 || *count > kMaxMoments) return too_many();
    return spread(static_cast<int>(*count), span);
  }
  const auto earlier = [](const ImageMoment& a, const ImageMoment& b) { return a.time < b.time; };
  std::set<ImageMoment, decltype(earlier)> chosen(earlier);
  for (const std::string_view word : parts(moments)) {
    const auto moment = parse_moment(word, span);
    if (!moment) return moment.error();
    chosen.insert(*moment);
    if (chosen.size() > kMaxMoments) return too_many();
  }
  return std::vector<ImageMoment>(chosen.begin(), chosen.end());
}

Status add_image(const render::Image& image, const std::string& path, OutputSet& outputs) {
  const auto bytes = render::write_png(image);
  if (!bytes) return bytes.error();
  return outputs.add(path, *bytes);
}

Json to_json(const render::CellLayout& cell) {
  const render::Camera& camera = cell.camera;
  Json json;
  json["row"] = cell.row;
  json["column"] = cell.column;
  json["box"] = {cell.left, cell.top, cell.right, cell.bottom};
  json["yaw"] = to_degrees(camera.yaw);
  json["elevation"] = to_degrees(camera.elevation);
  json["target"] = {camera.target.x(), camera.target.y(), camera.target.z()};
  json["target_pixel"] = {camera.place_of_target.x(), camera.place_of_target.y()};
  return json;
}

}  // namespace krok::cli
