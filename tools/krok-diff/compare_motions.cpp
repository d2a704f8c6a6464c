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

Result<Outcome> compare_motions(const InputFile& first, const InputFile& second,
                                const Options& options, ToolContext& context) {
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
  outcome.kind = word_of(InputKind::motion);
  outcome.summary = {fmt::format("motions: {}, {} compared",
                                 counted(clips->first.joint_count(), "joint"),
                                 counted(found->compared_frames, "frame"))};
  outcome.structure = found->structure;
  outcome.notes = found->notes;
  outcome.names.joints = clips->first.skeleton.names;
  outcome.add_row("reference positions", Unit::length, found->reference_positions);
  outcome.add_row("reference orientations", Unit::angle, found->reference_orientations);
  outcome.add_row("positions", Unit::length, found->positions);
  outcome.add_row("orientations", Unit::angle, found->orientations);
  outcome.add_row("stretches", Unit::ratio, found->stretches);
  outcome.add_joints(found->joints);
  outcome.same = found->same();
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
