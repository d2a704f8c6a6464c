#include "tools/krok-synth/sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "motion/sample.h"
#include "timeline/mix.h"

namespace krok::cli::synth {

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
