#include "tools/krok-render/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "core/numbers.h"
#include "core/parallel.h"
#include "core/result.h"
#include "formats/cam/cam.h"
#include "formats/film/film_writer.h"
#include "render/image.h"
#include "tools/cli/output_set.h"
#include "tools/cli/usage.h"
#include "tools/krok-render/shot.h"

namespace krok::cli::film {

namespace {

// Names of numbered files by a pattern with one %d or %0Nd, as ffmpeg takes them: "frame_%04d.png".
class FrameNames {
 public:
  // Without a number, the name of a single frame. Code usage for a pattern with several.
  static Result<FrameNames> parse(const std::string& given);
  std::string of(int frame) const;
  bool is_single() const { return is_single_; }

 private:
  std::string before_, after_;
  int digits_ = 1;
  bool is_single_ = false;
};

Result<FrameNames> FrameNames::parse(const std::string& given) {
  // "####" is %04d, as in other programs.
  std::string pattern = given;
  const std::size_t hash = pattern.find('#');
  const std::size_t behind = std::min(pattern.find_first_not_of('#', hash), pattern.size());
  if (pattern.find('%') == std::string::npos && hash != std::string::npos) {
    pattern.replace(hash, behind - hash, fmt::format("%0{}d", behind - hash));
  }
  const auto refused = [&pattern] {
    return usage(fmt::format("-o {}: a file per frame needs a number in its name", pattern),
                 "such as 'frame_%04d.png'; or write .mp4, .gif or .webp");
  };
  const std::size_t begin = pattern.find('%');
  FrameNames names;
  if (begin == std::string::npos) {
    names.before_ = pattern;
    names.is_single_ = true;
    return names;
  }
  if (pattern.find('%', begin + 1) != std::string::npos) return refused();
  std::size_t end = begin + 1;
  if (end < pattern.size() && pattern[end] == '0') ++end;
  int digits = 0;
  for (; end < pattern.size() && pattern[end] >= '0' && pattern[end] <= '9'; ++end) {
    digits = 10 * digits + (pattern[end] - '0');
    if (digits > 9) return refused();
  }
  if (end >= pattern.size() || pattern[end] != 'd') return refused();
  if (digits > 0) names.digits_ = digits;
  names.before_ = pattern.substr(0, begin);
  names.after_ = pattern.substr(end + 1);
  return names;
}

std::string FrameNames::of(int frame) const {
  return is_single_ ? before_ : fmt::format("{}{:0{}}{}", before_, frame, digits_, after_);
}

using krok::film::Kind;
using krok::film::Writer;

std::optional<Kind> kind_of(Format format) {
  switch (format) {
    case Format::mp4:
      return Kind::mp4;
    case Format::gif:
      return Kind::gif;
    case Format::webp:
      return Kind::webp;
    case Format::png:
    case Format::from_extension:
      break;
  }
  return std::nullopt;
}

// The motion's rate, or the largest whole part of it that is not faster than usual films.
double usual_rate(const MovingActor& actor, Format format) {
  const double most = format == Format::gif ? 25 : 30;
  if (!(actor.rate > 0)) return most;
  return actor.rate / std::max(1.0, std::ceil(actor.rate / most - 1e-3));
}

Result<std::vector<MovingActor>> read_all(const Options& options, ToolContext& context) {
  std::vector<std::string> paths = options.inputs;
  ActorOptions how = options.actors;
  how.first_is_model = !options.model.empty();
  how.from = options.from;
  how.to = options.to;
  if (how.first_is_model) paths.insert(paths.begin(), options.model);
  auto actors = read_actors(paths, how, context);
  if (!actors) return actors;
  if (!options.model.empty() && actors->size() != options.inputs.size()) {
    return Error("film-model",
                 fmt::format("the model's skeleton is not that of {}",
                             options.inputs.size() == 1 ? "the motion" : "one of the motions"),
                 "krok-retarget --onto puts a motion on the model's skeleton")
        .in_file(options.model);
  }
  if (options.difference && actors->size() != 2) {
    return usage(fmt::format("--difference needs two motions, not {}", actors->size()));
  }
  return actors;
}

Result<std::optional<CameraTrack>> read_camera(const std::string& path, ToolContext& context) {
  std::optional<CameraTrack> track;
  if (path.empty()) return track;
  const auto file = context.open_input(path);
  if (!file) return file.error();
  auto read = cam::read(file->bytes());
  if (!read) return std::move(read.error()).in_file(path);
  if (read->frame_count() == 0)
    return Error("film-camera", "the camera has no frames").in_file(path);
  track = *std::move(read);
  return track;
}

Result<Shot> make_shot(const Options& options, Format format, ToolContext& context,
                       ShotSetting& setting) {
  auto actors = read_all(options, context);
  if (!actors) return actors.error();
  const bool small = format == Format::gif || format == Format::webp;
  const auto size = options.size.value_or(small ? std::pair(480, 270) : std::pair(960, 540));
  setting.width = size.first;
  setting.height = size.second;
  const MovingActor& longest = *std::ranges::max_element(*actors, {}, &MovingActor::duration);
  const auto span = span_of(longest, options.from, options.to);
  if (!span) return span.error();
  setting.start = span->start;
  setting.end = span->end;
  setting.rate = options.fps.value_or(usual_rate(actors->front(), format));
  auto ground = open_sheet_ground(options.ground, options.prints, context);
  if (!ground) return ground.error();
  auto camera = read_camera(options.camera, context);
  if (!camera) return camera.error();
  return Shot::create(*std::move(actors), options, setting, *std::move(ground), *std::move(camera),
                      context.jobs);
}

// Renders all frames, several at once, and passes them on in order.
Status render_frames(const Shot& shot, const ShotSetting& setting, ToolContext& context,
                     const std::function<Status(int frame, const render::Image&)>& take) {
  struct Slot {
    std::optional<render::FilmPainter> painter;
    render::Image image;
  };
  const auto count = static_cast<std::size_t>(shot.frame_count());
  std::vector<Slot> slots(slots_for(context.jobs));
  context.progress->begin("rendering frames", count);
  return make_in_order(
      count, context.jobs,
      [&](std::size_t frame, std::size_t index) -> Status {
        Slot& slot = slots[index];
        if (!slot.painter) {
          auto painter = render::FilmPainter::create();
          if (!painter) return painter.error();
          slot.painter = *std::move(painter);
        }
        const auto made = shot.make(static_cast<int>(frame));
        auto image = slot.painter->paint(made->frame, setting.width, setting.height, 1);
        if (!image) return image.error();
        slot.image = *std::move(image);
        return {};
      },
      [&](std::size_t frame, std::size_t index) {
        context.progress->advance(1);
        return take(static_cast<int>(frame), slots[index].image);
      });
}

// Writes the film, or a file per frame; returns what to call it in the log.
Result<std::string> write(const Shot& shot, const ShotSetting& setting, Format format,
                          ToolContext& context) {
  OutputSet outputs(context);
  const auto kind = kind_of(format);
  if (!kind) {
    const auto names = FrameNames::parse(context.output);
    if (!names) return names.error();
    const Status status =
        render_frames(shot, setting, context, [&](int frame, const render::Image& image) {
          return add_image(image, names->of(frame), outputs);
        });
    if (!status) return status.error();
    if (Status end = outputs.finish(); !end) return end.error();
    if (names->is_single()) return context.output;
    return fmt::format("{} to {}", names->of(0), names->of(shot.frame_count() - 1));
  }
  auto writer = Writer::create(*kind, setting.width, setting.height, setting.rate);
  if (!writer) return writer.error();
  Status status = render_frames(shot, setting, context, [&](int, const render::Image& image) {
    return writer->add(image.rgb);
  });
  if (!status) return status.error();
  status = outputs.add(context.output, [&](OutputFile& file) { return writer->finish(file); });
  if (status) status = outputs.finish();
  if (!status) return status.error();
  return context.output;
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  bool single = false;
  const auto format = format_of(options, context.output);
  if (!format) return format.error();
  if (*format == Format::png) {
    const auto names = FrameNames::parse(context.output);
    if (!names) return names.error();
    if (names->is_single() && options.to) {
      return usage(fmt::format("-o {} is one frame, that of --from", context.output),
                   "'frame_%04d.png' is a file per frame");
    }
    single = names->is_single();
  } else if (Status status = krok::film::check_encoder(); !status) {
    return status.error();
  }
  ShotSetting setting;
  Options chosen = options;
  if (single) chosen.to = chosen.from.value_or(ClipTime());
  const auto shot = make_shot(chosen, *format, context, setting);
  if (!shot) return shot.error();
  const auto written = write(*shot, setting, *format, context);
  if (!written) return written.error();
  const int frames = shot->frame_count();
  Json& result = context.report.result;
  result["frames"] = frames;
  result["rate"] = setting.rate;
  result["start"] = setting.start;
  result["duration"] = frames / setting.rate;
  result["width"] = setting.width;
  result["height"] = setting.height;
  if (options.difference) result["largest_distance"] = shot->largest();
  result["views"] = shot->views_json();
  context.log(fmt::format("{}: {} at {} fps, {} x {} pixels{}", *written, counted(frames, "frame"),
                          readable(setting.rate, 4), setting.width, setting.height,
                          options.difference ? fmt::format(", distance up to {} mm",
                                                           readable(1000 * shot->largest(), 4))
                                             : ""));
  return kExitDone;
}

}  // namespace krok::cli::film
