#include "compare/model_difference.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "compare/matching.h"
#include "compare/mesh_difference.h"
#include "math/quaternion.h"

namespace krok::compare {

namespace {

void say_only_in(const char* which, const MorphSet& morphs, const std::vector<int>& targets,
                 MorphDifference& result) {
  for (const int target : targets) {
    result.structure.push_back(fmt::format("target {} is only in the {}",
                                           morphs.names[static_cast<std::size_t>(target)], which));
  }
}

}  // namespace

Result<MorphDifference> difference(const MorphSet& first, const MorphSet& second,
                                   const Tolerance& tolerance, Matching matching) {
  for (const MorphSet* morphs : {&first, &second}) {
    if (auto ok = check(*morphs); !ok) {
      Error error = ok.error();
      error.message = fmt::format("the {} morph targets: {}", morphs == &first ? "first" : "second",
                                  error.message);
      return error;
    }
  }
  MorphDifference result;
  result.positions = Measure(tolerance.length);
  result.normals = Measure(tolerance.of_normals());
  if (first.vertex_count != second.vertex_count) {
    result.structure.push_back(fmt::format("{} vertices in the first, {} in the second",
                                           first.vertex_count, second.vertex_count));
    return result;
  }
  if (first.normals.empty() != second.normals.empty()) {
    result.structure.push_back(
        fmt::format("only the {} has normals", first.normals.empty() ? "second" : "first"));
  }
  if (matching != Matching::order) matching = Matching::name;
  const ListMatch match = match_lists(first.names, second.names, matching);
  say_only_in("first", first, match.only_first, result);
  say_only_in("second", second, match.only_second, result);
  for (const auto& [i, j] : match.pairs) {
    const ValueLocation place{.target = i};
    add_distances(first.target_positions(i), second.target_positions(j), place, result.positions);
    if (first.normals.empty() || second.normals.empty()) continue;
    add_angles(first.target_normals(i), second.target_normals(j), place, result.normals);
  }
  result.compared_targets = static_cast<int>(match.pairs.size());
  return result;
}

namespace {

std::string shown_cuts(const CameraTrack& camera) {
  constexpr std::size_t kShown = 5;
  const auto& cuts = camera.cuts;
  if (cuts.empty()) return "none";
  const auto last = cuts.begin() + static_cast<std::ptrdiff_t>(std::min(cuts.size(), kShown));
  return fmt::format("{}{}", fmt::join(cuts.begin(), last, ", "), last == cuts.end() ? "" : " ...");
}

}  // namespace

Result<CameraDifference> difference(const CameraTrack& first, const CameraTrack& second,
                                    const Tolerance& tolerance) {
  for (const CameraTrack* camera : {&first, &second}) {
    if (auto ok = check(*camera); !ok) {
      Error error = ok.error();
      error.message =
          fmt::format("the {} camera: {}", camera == &first ? "first" : "second", error.message);
      return error;
    }
  }
  CameraDifference result;
  result.positions = Measure(tolerance.length);
  result.orientations = result.fields_of_view = Measure(tolerance.angle);

  FrameMatch frames =
      match_frames(first.frame_count(), first.rate, second.frame_count(), second.rate);
  result.structure = std::move(frames.differences);
  result.compared_frames = static_cast<int>(frames.frames.size());
  if (result.structure.empty() && first.cuts != second.cuts) {
    result.structure.push_back(fmt::format("cuts at frames {} in the first, {} in the second",
                                           shown_cuts(first), shown_cuts(second)));
  }
  for (const auto& [frame_a, frame_b] : frames.frames) {
    const auto i = static_cast<std::size_t>(frame_a);
    const auto j = static_cast<std::size_t>(frame_b);
    const ValueLocation place{.frame = frame_a, .time = frame_a / first.rate};
    const Vec3 apart = first.positions[i].cast<double>() - second.positions[j].cast<double>();
    result.positions.add(apart.norm(), place);
    result.orientations.add(
        angle_between(first.orientations[i].cast<double>(), second.orientations[j].cast<double>()),
        place);
    result.fields_of_view.add(std::abs(static_cast<double>(first.fields_of_view[i]) -
                                       static_cast<double>(second.fields_of_view[j])),
                              place);
  }
  return result;
}

}  // namespace krok::compare
