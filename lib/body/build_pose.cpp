#include "body/build_pose.h"

#include <fmt/format.h>

#include <algorithm>

#include "body/human_pose.h"
#include "retarget/stance.h"

namespace krok::body {

namespace {

// Moves a pose of a clip, which is at the captured position, to the origin.
void bring_home(std::vector<Transform>& pose) {
  Vec3 middle = pose.front().position;
  double low = middle.y();
  for (const Transform& transform : pose) low = std::min(low, transform.position.y());
  for (Transform& transform : pose) transform.position -= Vec3(middle.x(), low, middle.z());
}

constexpr int kSamples = 60;  // candidate frames

// Total bone rotation (radians) above which a frame may be better than the reference pose.
constexpr double kTooMuch = 4.0;

// The spread of a pose's bones: the mean distance from a bone's midpoint to that of the nearest
// bone that it is not connected to, over the total bone length.
double spread(const Skeleton& skeleton, std::span<const Transform> pose) {
  std::vector<Vec3> middles;
  std::vector<std::pair<int, int>> ends;
  double total = 0;
  for (std::size_t j = 1; j < pose.size(); ++j) {
    const int parent = skeleton.parents[j];
    const Vec3& from = pose[static_cast<std::size_t>(parent)].position;
    const double length = (pose[j].position - from).norm();
    if (!(length > 0)) continue;
    total += length;
    middles.push_back(0.5 * (from + pose[j].position));
    ends.emplace_back(parent, static_cast<int>(j));
  }
  double sum = 0;
  std::size_t pairs = 0;
  const std::size_t stride = std::max<std::size_t>(1, middles.size() / 100);
  for (std::size_t a = 0; a < middles.size(); a += stride) {
    double nearest = total;
    for (std::size_t b = 0; b < middles.size(); b += stride) {
      const bool meet = ends[a].first == ends[b].first || ends[a].first == ends[b].second ||
                        ends[a].second == ends[b].first || ends[a].second == ends[b].second;
      if (!meet) nearest = std::min(nearest, (middles[a] - middles[b]).norm());
    }
    if (nearest < total) sum += nearest, ++pairs;
  }
  return pairs > 0 && total > 0 ? sum / (static_cast<double>(pairs) * total) : 1.0;
}

}  // namespace

std::vector<Transform> clip_pose(const Clip& clip, int frame) {
  std::vector<Transform> pose(clip.skeleton.names.size());
  clip.get_pose(frame, pose);
  return pose;
}

BuildPose human_build_pose(const Clip& clip, const RoleMap& roles, const HumanActor& actor) {
  const Skeleton& skeleton = clip.skeleton;
  StandingPose best = stand_upright(skeleton, actor, skeleton.reference);
  std::string name = best.turned > 0    ? "reference, limbs turned aside"
                     : best.heading > 0 ? "reference, turned upright"
                                        : "reference";
  if (best.turned > kTooMuch) {
    StandingPose built =
        stand_upright(skeleton, actor, retarget::neutral_skeleton(clip, roles).reference);
    if (built.turned < 0.6 * best.turned) {
      best = std::move(built);
      bring_home(best.joint_to_world);
      name = "T-pose built from the skeleton";
    }
  }
  return {std::move(best.joint_to_world), std::move(name)};
}

BuildPose general_build_pose(const Clip& clip) {
  const Skeleton& skeleton = clip.skeleton;
  BuildPose best{skeleton.reference, "reference"};
  double most = 1.5 * spread(skeleton, skeleton.reference);
  const int frames = clip.frame_count();
  const int step = std::max(1, frames / kSamples);
  for (int frame = 0; frame < frames; frame += step) {
    auto pose = clip_pose(clip, frame);
    const double candidate = spread(skeleton, pose);
    if (candidate <= most) continue;
    most = candidate;
    bring_home(pose);
    best = {std::move(pose), fmt::format("frame {}", frame)};
  }
  return best;
}

}  // namespace krok::body
