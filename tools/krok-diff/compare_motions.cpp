#include <fmt/format.h>

#include "compare/camera_difference.h"
#include "compare/clip_difference.h"
#include "core/numbers.h"
#include "formats/cam/cam.h"
#include "formats/io/open_motion.h"
#include "tools/krok-diff/compare_two.h"
#include "tools/krok-diff/comparisons.h"
#include "tools/krok-diff/difference_plot.h"

namespace krok::cli::diff {

namespace {

// Files from this size on are compared block by block.
constexpr std::size_t kLongFile = std::size_t{64} << 20;

void add_rows(const Skeleton& skeleton, const compare::ClipDifference& found, Outcome& outcome) {
  outcome.kind = word_of(InputKind::motion);
  outcome.summary = {fmt::format("motions: {}, {} compared",
                                 counted(skeleton.joint_count(), "joint"),
                                 counted(found.compared_frames, "frame"))};
  outcome.structure = found.structure;
  outcome.notes = found.notes;
  outcome.names.joints = skeleton.names;
  outcome.add_row("reference positions", Unit::length, found.reference_positions);
  outcome.add_row("reference orientations", Unit::angle, found.reference_orientations);
  outcome.add_row("positions", Unit::length, found.positions);
  outcome.add_row("orientations", Unit::angle, found.orientations);
  outcome.add_row("stretches", Unit::ratio, found.stretches);
  outcome.add_joints(found.joints);
  outcome.same = found.same();
}

// Without either motion in memory as a whole.
Result<Outcome> compare_long_motions(const InputFile& first, const InputFile& second,
                                     const Options& options, ToolContext& context) {
  std::optional<Result<compare::ClipDifference>> found;
  Stretches stretches[2];
  const auto facts = io::stream_motion(
      first, context,
      [&](const FrameSource& a) -> Status {
        const auto other = io::stream_motion(
            second, context,
            [&](const FrameSource& b) -> Status {
              FrameSource counted_frames = a;
              counted_frames.read = [&](int from, int count, std::span<Vec3f> positions,
                                        std::span<Quatf> orientations) {
                context.progress->advance(static_cast<std::uint64_t>(count));
                return a.read(from, count, positions, orientations);
              };
              context.progress->begin("comparing frames",
                                      static_cast<std::uint64_t>(a.frame_count));
              found = compare::difference(counted_frames, b, options.tolerance, options.matching,
                                          stretches[0], stretches[1], context.jobs);
              context.progress->end();
              return *found ? Status() : Status(found->error());
            },
            {.stretches = &stretches[1]});
        return other ? Status() : Status(other.error());
      },
      {.stretches = &stretches[0]});
  if (!facts) return facts.error();
  Outcome outcome;
  add_rows(facts->skeleton, **found, outcome);
  return outcome;
}

}  // namespace

Result<Outcome> compare_motions(const InputFile& first, const InputFile& second,
                                const Options& options, ToolContext& context) {
  const bool drawn = !options.sheet.path.empty() || !options.plot.empty() || options.has_page();
  if (!drawn && first.bytes().size() + second.bytes().size() >= kLongFile) {
    return compare_long_motions(first, second, options, context);
  }
  std::vector<Stretches> stretches;
  auto clips = read_both<Clip>(first, second, [&](const InputFile& file) {
    return io::open_motion(file, context, {.stretches = &stretches.emplace_back()});
  });
  if (!clips) return clips.error();
  const auto found = compare::difference(clips->first, clips->second, options.tolerance,
                                         options.matching, stretches[0], stretches[1]);
  if (!found) return found.error();
  Outcome outcome;
  const Status status = draw(
      options, context, found->same(),
      [&] { return sheet_of(clips->first, clips->second, found->positions); }, outcome.pictures);
  if (!status) return status.error();
  const auto [first_name, second_name] = image_names(options);
  const PlottedClip a{first_name, &clips->first};
  const PlottedClip b{second_name, &clips->second};
  const Status step = plot(
      options, context, found->same(), [&] { return plot_of(a, b, *found); }, outcome.chart);
  if (!step) return step.error();
  add_rows(clips->first.skeleton, *found, outcome);
  return outcome;
}

Result<Outcome> compare_cameras(const InputFile& first, const InputFile& second,
                                const Options& options) {
  auto cameras = read_both<CameraTrack>(
      first, second, [](const InputFile& file) { return cam::read(file.bytes()); });
  if (!cameras) return cameras.error();
  const auto found = compare::difference(cameras->first, cameras->second, options.tolerance);
  if (!found) return found.error();
  Outcome outcome;
  outcome.kind = word_of(InputKind::camera);
  outcome.summary = {fmt::format("cameras: {} compared", counted(found->compared_frames, "frame"))};
  outcome.structure = found->structure;
  outcome.add_row("positions", Unit::length, found->positions);
  outcome.add_row("orientations", Unit::angle, found->orientations);
  outcome.add_row("fields of view", Unit::angle, found->fields_of_view);
  outcome.same = found->same();
  return outcome;
}

}  // namespace krok::cli::diff
