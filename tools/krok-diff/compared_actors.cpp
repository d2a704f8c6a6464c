// Contents of a sheet for clips, models and scenes.

#include <algorithm>
#include <cmath>

#include "compare/matching.h"
#include "core/index.h"
#include "motion/hips_root.h"
#include "roles/body_frame.h"
#include "roles/roles.h"
#include "tools/krok-diff/difference_sheet.h"
#include "tools/shared/bone_actor.h"

namespace krok::cli::diff {

namespace {

using render::Actor;
using render::ColourKey;

double in_unit(const ColourKey& key, double metres) {
  return key.unit == "mm" ? 1000 * metres : key.unit == "cm" ? 100 * metres : metres;
}

// Colours points by their distance to others; `largest` receives the max.
template <typename Points, typename Others>
std::vector<render::Colour> colours_of(const Points& points, const Others& others,
                                       const ColourKey& key, std::optional<double>& largest) {
  std::vector<render::Colour> colours;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double distance =
        (points[i].template cast<double>() - others[i].template cast<double>()).norm();
    largest = std::max(largest.value_or(0.0), distance);
    colours.push_back(key.at(in_unit(key, distance)));
  }
  return colours;
}

void stand_at(const Vec3& place, Actor& actor) {
  actor.centre = Vec3(place.x(), 0, place.z());
}

// Two clips drawn as bones.
class ClipPair {
 public:
  ClipPair(const Clip& first, const Clip& second)
      : first_(first),
        second_(second),
        first_style_(bone_style(first.skeleton)),
        second_style_(bone_style(second.skeleton)),
        carrier_(carrying_joint(find_roles(first.skeleton))),
        front_(front_of(first.skeleton, find_roles(first.skeleton))) {
    const auto skeletons = compare::match_skeletons(first.skeleton, second.skeleton);
    first_of_second_.assign(second.skeleton.names.size(), -1);
    for (std::size_t j = 0; j < skeletons.second_of_first.size(); ++j) {
      if (skeletons.second_of_first[j] < 0) continue;
      first_of_second_[static_cast<std::size_t>(skeletons.second_of_first[j])] =
          static_cast<int>(j);
    }
    corresponds_ = skeletons.difference.empty();
    frames_ =
        compare::match_frames(first.frame_count(), first.rate, second.frame_count(), second.rate)
            .frames;
  }

  bool corresponds() const { return corresponds_; }
  const std::vector<std::pair<int, int>>& frames() const { return frames_; }

  double heading(int frame) const {
    return front_ +
           (first_.frame_count() > 0 ? ground_frame(first_, carrier_, frame).heading : 0.0);
  }

  Compared at(const ImageMoment& moment, const ColourKey& key) const {
    std::vector<Vec3f> a = reference(first_);
    std::vector<Vec3f> b = reference(second_);
    if (!frames_.empty()) {
      const auto pair = nearest(moment.frame);
      const auto first = first_.frame_positions(pair.first);
      const auto second = second_.frame_positions(pair.second);
      a.assign(first.begin(), first.end());
      b.assign(second.begin(), second.end());
    }
    Compared result;
    result.first = bone_actor(first_style_, a);
    result.second = bone_actor(second_style_, b);
    BoneStyle style = second_style_;
    if (corresponds_) {
      std::vector<Vec3f> others;
      for (const int joint : first_of_second_) others.push_back(a[static_cast<std::size_t>(joint)]);
      style.colours = colours_of(b, others, key, result.largest);
      style.blended = true;
    }
    result.coloured = bone_actor(style, b);
    const Vec3 place = a[static_cast<std::size_t>(carrier_)].cast<double>();
    for (Actor* actor : {&result.first, &result.second, &result.coloured}) {
      stand_at(place, *actor);
    }
    return result;
  }

 private:
  static std::vector<Vec3f> reference(const Clip& clip) {
    std::vector<Vec3f> positions;
    for (const Transform& joint : clip.skeleton.reference) {
      positions.push_back(joint.position.cast<float>());
    }
    return positions;
  }

  std::pair<int, int> nearest(int frame) const {
    return *std::min_element(frames_.begin(), frames_.end(), [frame](const auto& a, const auto& b) {
      return std::abs(a.first - frame) < std::abs(b.first - frame);
    });
  }

  const Clip& first_;
  const Clip& second_;
  BoneStyle first_style_, second_style_;
  int carrier_ = 0;
  double front_ = 0;
  bool corresponds_ = false;
  std::vector<int> first_of_second_;
  std::vector<std::pair<int, int>> frames_;
};

// A scene's meshes, or its joints if it has no triangles.
class ScenePart {
 public:
  // `dressed`: in the base colours of its materials, without textures.
  ScenePart(const Scene& scene, bool dressed) : scene_(scene) {
    for (const SceneMesh& mesh : scene.meshes) {
      colours_.push_back(kBodyColour);
      if (dressed && mesh.material != nullptr) {
        colours_.back() = render::to_colour(mesh.material->base_color.head<3>());
      }
      triangles_.push_back(
          std::make_shared<render::Triangles>(mesh.triangles.begin(), mesh.triangles.end()));
    }
    style_.parents = scene.joint_parents;
    style_.colours.assign(scene.joint_names.size(), side_colour(BodySide::middle));
  }

  bool has_surface() const {
    return std::any_of(triangles_.begin(), triangles_.end(),
                       [](const auto& triangles) { return !triangles->empty(); });
  }

  SceneState state(double time) const {
    SceneState state;
    scene_.evaluate(scene_.animations.empty() ? -1 : 0, time, state);
    return state;
  }

  Actor actor(const SceneState& state) const {
    Actor actor;
    if (!has_surface()) return bones(state, style_.colours, false);
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      render::Surface surface;
      for (const Vec3& point : state.positions[i]) surface.positions.push_back(point.cast<float>());
      for (const Vec3& normal : state.normals[i]) surface.normals.push_back(normal.cast<float>());
      surface.triangles = triangles_[i];
      surface.colours = {colours_[i]};
      actor.surfaces.push_back(std::move(surface));
    }
    return actor;
  }

  Actor bones(const SceneState& state, std::vector<render::Colour> colours, bool blended) const {
    BoneStyle style = style_;
    style.colours = std::move(colours);
    style.blended = blended;
    const auto positions = joints(state);
    Eigen::AlignedBox3f box;
    for (const Vec3f& point : positions) box.extend(point);
    if (!positions.empty()) {
      style.radius = bone_radius(static_cast<double>(box.sizes().maxCoeff()));
    }
    return bone_actor(style, positions);
  }

  static std::vector<Vec3f> joints(const SceneState& state) {
    std::vector<Vec3f> positions;
    for (const Transform& joint : state.joints) positions.push_back(joint.position.cast<float>());
    return positions;
  }

  const Scene& scene() const { return scene_; }

 private:
  const Scene& scene_;
  std::vector<std::shared_ptr<const render::Triangles>> triangles_;
  std::vector<render::Colour> colours_;  // [meshes]
  BoneStyle style_;
};

class ScenePair {
 public:
  ScenePair(const Scene& first, const Scene& second, compare::Matching matching, bool dressed)
      : first_(first, dressed),
        second_(second, dressed),
        first_of_second_(second.meshes.size(), 0) {
    const auto match = compare::match_lists(mesh_names(first), mesh_names(second), matching);
    corresponds_ = matching != compare::Matching::nearest && match.only_first.empty() &&
                   match.only_second.empty();
    for (const auto& [i, j] : match.pairs) {
      const auto a = static_cast<std::size_t>(i);
      const auto b = static_cast<std::size_t>(j);
      first_of_second_[b] = a;
      corresponds_ = corresponds_ && first.meshes[a].vertex_count == second.meshes[b].vertex_count;
    }
    if (!second_.has_surface()) {
      corresponds_ = corresponds_ && first.joint_names == second.joint_names;
    }
    joints_ = skeleton_of(first);
    if (check(joints_)) roles_ = find_roles(joints_);
  }

  bool corresponds() const { return corresponds_; }

  // Of the first, at the start.
  double heading() const {
    const auto front = heading_of(roles_, joints_.reference);
    if (!front) return 0;
    const int carrier = carrying_joint(roles_);
    return *front +
           ground_frame(joints_, carrier, first_.state(0).joints[krok::at(carrier)]).heading;
  }

  // The duration that both are animated; 0 if one is not.
  double duration() const {
    double least = 0;
    for (const ScenePart* part : {&first_, &second_}) {
      const auto& animations = part->scene().animations;
      if (animations.empty() || animations[0].key_times.empty()) return 0;
      const double last = animations[0].key_times.back();
      least = part == &first_ ? last : std::min(least, last);
    }
    return std::max(0.0, least);
  }

  Compared at(double time, const ColourKey& key) const {
    const auto a = first_.state(time);
    const auto b = second_.state(time);
    Compared result;
    result.first = first_.actor(a);
    result.second = second_.actor(b);
    result.coloured = result.second;
    for (render::Surface& surface : result.coloured.surfaces) surface.colours = {kBodyColour};
    if (corresponds_ && second_.has_surface()) {
      for (std::size_t i = 0; i < result.coloured.surfaces.size(); ++i) {
        auto colours =
            colours_of(b.positions[i], a.positions[first_of_second_[i]], key, result.largest);
        if (!colours.empty()) result.coloured.surfaces[i].colours = std::move(colours);
      }
    } else if (corresponds_) {
      result.coloured = second_.bones(
          b, colours_of(ScenePart::joints(b), ScenePart::joints(a), key, result.largest), true);
    }
    if (first_.scene().only_still && second_.scene().only_still) return result;
    const render::Bounds box = render::bounds(result.first);
    const Vec3 place = a.joints.empty() ? Vec3(0.5 * (box.low + box.high))
                                        : a.joints[krok::at(carrying_joint(roles_))].position;
    for (Actor* actor : {&result.first, &result.second, &result.coloured}) {
      stand_at(place, *actor);
    }
    return result;
  }

 private:
  static std::vector<std::string> mesh_names(const Scene& scene) {
    std::vector<std::string> names;
    for (const SceneMesh& mesh : scene.meshes) names.push_back(mesh.name);
    return names;
  }

  ScenePart first_, second_;
  std::vector<std::size_t> first_of_second_;  // of meshes
  Skeleton joints_;                           // of the first, in the pose without animation
  RoleMap roles_;                             // its; none for other than one skeleton
  bool corresponds_ = false;
};

}  // namespace

DifferenceSheet sheet_of(const Clip& first, const Clip& second, const compare::Measure& found) {
  const auto pair = std::make_shared<const ClipPair>(first, second);
  DifferenceSheet sheet;
  sheet.measured = pair->corresponds();
  sheet.largest = found.largest;
  sheet.tolerance = found.tolerance;
  if (!pair->frames().empty()) {
    sheet.span.rate = first.rate;
    sheet.span.first = pair->frames().front().first;
    sheet.span.last = pair->frames().back().first;
    sheet.span.start = sheet.span.first / first.rate;
    sheet.span.end = sheet.span.last / first.rate;
    sheet.heading = pair->heading(sheet.span.first);
    if (found.largest > 0) {
      sheet.worst = ImageMoment{found.where.frame / first.rate, found.where.frame};
    }
  }
  sheet.at = [pair](const ImageMoment& moment, const ColourKey& key) {
    return pair->at(moment, key);
  };
  return sheet;
}

DifferenceSheet sheet_of(const Scene& first, const Scene& second, const compare::Measure& found,
                         compare::Matching matching, bool dressed) {
  const auto pair = std::make_shared<const ScenePair>(first, second, matching, dressed);
  DifferenceSheet sheet;
  sheet.measured = pair->corresponds();
  sheet.largest = found.largest;
  sheet.tolerance = found.tolerance;
  sheet.span.end = pair->duration();
  sheet.heading = pair->heading();
  const bool still = first.only_still && second.only_still;
  if (!still && found.largest > 0 && found.where.animation <= 0 &&
      found.where.time <= sheet.span.end) {
    sheet.worst = ImageMoment{found.where.time, -1};
  }
  sheet.at = [pair](const ImageMoment& moment, const ColourKey& key) {
    return pair->at(moment.time, key);
  };
  return sheet;
}

}  // namespace krok::cli::diff
