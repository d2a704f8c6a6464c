#include "camera/actor_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "camera/framing.h"
#include "camera/look_at.h"
#include "camera/spring.h"
#include "core/index.h"
#include "motion/ground_frame.h"
#include "roles/body_frame.h"

namespace krok {

namespace {

constexpr double kFarthest = 1e4;  // metres
constexpr int kMaxTries = 500;
constexpr double kCloseEnough = 0.999;  // fraction of a distance that works
constexpr double kLargestMargin = 0.45;
constexpr double kFastestTurn = 90 * kRadiansPerDegree;      // a second, with the actor's facing
constexpr double kMoreSmoothing = 1.25, kMaxSmoothing = 20;  // factor, seconds

Status check(const Clip& clip, const ActorCamera& camera) {
  const auto wrong = [](const char* what) { return Error("camera-value", what); };
  if (camera.joint >= clip.joint_count())
    return wrong("the joint to follow is not in the skeleton");
  if (!(camera.field_of_view > 0 && camera.field_of_view < kPi)) {
    return wrong("the field of view is not between 0 and 180 degrees");
  }
  if (!(camera.aspect > 0) || !std::isfinite(camera.aspect)) {
    return wrong("the aspect ratio is not greater than 0");
  }
  if (!(camera.margin >= 0 && camera.margin <= kLargestMargin)) {
    return wrong("the margin is not from 0 to 0.45");
  }
  if (!(std::abs(camera.elevation) <= kPi / 2 + 1e-9)) {
    return wrong("the elevation is not between -90 and 90 degrees");
  }
  if (!std::isfinite(camera.azimuth) || !std::isfinite(camera.turning) ||
      !std::isfinite(camera.smoothing) || !(camera.dead_zone >= 0)) {
    return wrong("azimuth, turning, smoothing or dead zone is not finite or is out of range");
  }
  if (camera.distance && !(*camera.distance > 0 && *camera.distance <= kFarthest)) {
    return wrong("the distance is not between 0 and 10 km");
  }
  return {};
}

// The bounding box of everything to be framed.
struct Box {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;

  void add(const Ball& ball) {
    low = low.cwiseMin(ball.centre - Vec3::Constant(ball.radius));
    high = high.cwiseMax(ball.centre + Vec3::Constant(ball.radius));
  }
  Vec3 middle() const { return (low + high) / 2; }
};

// The followed point stays put until the path is farther away than the radius.
void apply_dead_zone(double radius, std::span<Vec3> path) {
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Vec3 way = path[i] - path[i - 1];
    const double length = way.norm();
    path[i] = length > radius ? Vec3(path[i] - radius / length * way) : path[i - 1];
  }
}

// The camera's positions and directions while its distance is searched.
class Shooting {
 public:
  Shooting(const Clip& clip, const RoleMap& roles, const ActorCamera& camera, ActorShape shape)
      : clip_(clip),
        camera_(camera),
        shape_(std::move(shape)),
        frames_(clip.frame_count()),
        wanted_(ImageExtent::of(camera.field_of_view, camera.aspect, camera.margin)),
        edges_(ImageExtent::of(camera.field_of_view, camera.aspect, 0)) {
    find_ground(foot_joints(clip.skeleton, roles));
    find_azimuths(carrying_joint(roles), front_of(clip.skeleton, roles));
  }

  Result<ActorShot> shoot() {
    const bool still =
        camera_.joint < 0 && camera_.turning == 0 && camera_.azimuth_from != AzimuthFrom::actor;
    if (still && !camera_.distance && stand_still()) return result();
    find_path();
    if (camera_.distance) {
      place(*camera_.distance);
      return result();
    }
    if (!find_distance()) {
      return Error("camera-frame", "no camera position within 10 km shows everything to be framed",
                   "check the motion for stray joints; --frame or --map can exclude them");
    }
    return result();
  }

 private:
  void find_ground(const std::vector<int>& feet) {
    ground_ = std::numeric_limits<double>::infinity();
    for (int f = 0; f < frames_; ++f) {
      for (const int j : feet) {
        ground_ = std::min(ground_, static_cast<double>(clip_.frame_positions(f)[at(j)].y()));
      }
    }
  }

  void find_azimuths(int carrier, double front) {
    const auto heading = [&](int frame) {
      return front + ground_frame(clip_, carrier, frame).heading;
    };
    const double start = camera_.azimuth_from != AzimuthFrom::world ? heading(0) : 0;
    // As the x of vectors, to use the same smoothing as for the path.
    std::vector<Vec3> headings(at(frames_), Vec3(start, 0, 0));
    if (camera_.azimuth_from == AzimuthFrom::actor) {
      for (int f = 1; f < frames_; ++f) {
        const double before = headings[at(f - 1)].x();
        headings[at(f)].x() = before + wrapped(heading(f) - before);
      }
      smooth_turning(headings);
    }
    for (int f = 0; f < frames_; ++f) {
      azimuths_.push_back(headings[at(f)].x() + camera_.azimuth + camera_.turning * f / clip_.rate);
    }
  }

  // Smooths as asked, and longer where the camera would whip round.
  void smooth_turning(std::vector<Vec3>& headings) const {
    const std::vector<Vec3> given = headings;
    for (double time = camera_.smoothing; time > 0; time *= kMoreSmoothing) {
      headings = given;
      smooth_both_ways(headings, clip_.rate, time);
      double fastest = 0;
      for (std::size_t f = 1; f < headings.size(); ++f) {
        fastest = std::max(fastest, std::abs(headings[f].x() - headings[f - 1].x()) * clip_.rate);
      }
      if (fastest <= kFastestTurn || time > kMaxSmoothing) return;
    }
  }

  std::span<const Ball> shown(int frame) {
    balls_of(shape_, shape_.shown, clip_.frame_positions(frame), balls_);
    return balls_;
  }

  // The point the camera looks at in each frame.
  void find_path() {
    Box whole;
    double above = 0;
    for (int f = 0; f < frames_; ++f) {
      Box box;
      for (const Ball& ball : shown(f)) {
        box.add(ball);
        whole.add(ball);
      }
      if (camera_.joint < 0) continue;
      const Vec3 joint = clip_.frame_positions(f)[at(camera_.joint)].cast<double>();
      path_.push_back(joint);
      above += (box.middle().y() - joint.y()) / frames_;
    }
    if (camera_.joint < 0) {
      path_.assign(at(frames_), whole.middle());
      return;
    }
    apply_dead_zone(camera_.dead_zone, path_);
    smooth_both_ways(path_, clip_.rate, camera_.smoothing);
    for (Vec3& place : path_) place.y() += above;
  }

  // All frames in one image, from as close as possible. False if that position is below the ground
  // or inside the body.
  bool stand_still() {
    const Quat direction = looking_from(azimuths_[0], camera_.elevation);
    CameraFit tight(wanted_, direction);
    for (int f = 0; f < frames_; ++f) {
      for (const Ball& ball : shown(f)) tight.add(ball);
    }
    const Vec3 eye = tight.place();
    if (eye.y() < ground_ + kClearance || !eye.allFinite()) return false;
    eyes_.assign(at(frames_), eye);
    directions_.assign(at(frames_), direction);
    distance_ = (tight.nearest() + tight.farthest()) / 2;
    return is_clear();
  }

  // Places the camera in all frames, above the ground if `over_ground`.
  void place(double distance, bool over_ground = true) {
    distance_ = distance;
    eyes_.clear();
    directions_.clear();
    for (int f = 0; f < frames_; ++f) {
      double elevation = std::clamp(camera_.elevation, -kPi / 2, kPi / 2);
      // The sine of the elevation at which the camera clears the ground.
      const double least = (ground_ + kClearance - path_[at(f)].y()) / distance;
      if (over_ground && least > std::sin(elevation)) elevation = std::asin(std::min(least, 1.0));
      const Quat direction = looking_from(azimuths_[at(f)], elevation);
      directions_.push_back(direction);
      eyes_.emplace_back(path_[at(f)] + distance * (direction * Vec3::UnitZ()));
    }
  }

  // The distance required with the current directions.
  double needed() {
    double distance = 0;
    for (int f = 0; f < frames_; ++f) {
      distance = std::max(distance,
                          distance_to_frame(wanted_, directions_[at(f)], path_[at(f)], shown(f)));
    }
    return distance;
  }

  bool is_clear() const {
    for (int f = 0; f < frames_; ++f) {
      if (distance_to_body(shape_, clip_.frame_positions(f), eyes_[at(f)]) < kClearance) {
        return false;
      }
    }
    return true;
  }

  // The first result is exact if the camera is above the ground and clear of the character.
  // Otherwise the directions depend on the distance: increase it until it works, then bisect.
  bool find_distance() {
    place(1, false);
    double distance = std::max(needed(), 1e-3);
    double failing = 0, working = 0;  // 0 for none
    for (int attempt = 0; attempt < kMaxTries && distance <= kFarthest; ++attempt) {
      place(distance);
      const double asked = needed();
      const bool works = asked <= distance * (1 + 1e-12) && is_clear();
      (works ? working : failing) = distance;
      if (works && (asked > kCloseEnough * distance || failing > kCloseEnough * distance)) {
        return true;
      }
      if (working > 0) {
        if (failing > kCloseEnough * working) break;
        distance = (failing + working) / 2;
      } else {
        distance = std::max(asked, distance * 1.05);
      }
    }
    if (working > 0) place(working);
    return working > 0;
  }

  Result<ActorShot> result() {
    ActorShot shot;
    shot.track.rate = clip_.rate;
    shot.distance = distance_;
    for (int f = 0; f < frames_; ++f) {
      const Vec3f eye = eyes_[at(f)].cast<float>();
      const Quatf direction = directions_[at(f)].cast<float>().normalized();
      shot.track.positions.push_back(eye);
      shot.track.orientations.push_back(direction);
      shot.track.fields_of_view.push_back(static_cast<float>(camera_.field_of_view));
      if (shows_all(edges_, eyes_[at(f)], directions_[at(f)], shown(f))) {
        ++shot.frames_shown;
      } else if (shot.first_not_shown < 0) {
        shot.first_not_shown = f;
      }
      if (distance_to_body(shape_, clip_.frame_positions(f), eyes_[at(f)]) < kClearance - 1e-6) {
        ++shot.frames_inside;
        if (shot.first_inside < 0) shot.first_inside = f;
      }
    }
    if (Status status = krok::check(shot.track); !status) return status.error();
    return shot;
  }

  const Clip& clip_;
  const ActorCamera& camera_;
  ActorShape shape_;
  int frames_;
  ImageExtent wanted_, edges_;  // with the margin, and without
  double ground_ = 0, distance_ = 0;
  std::vector<double> azimuths_;
  std::vector<Vec3> path_, eyes_;
  std::vector<Quat> directions_;
  std::vector<Ball> balls_;
};

}  // namespace

Result<ActorShot> film(const Clip& clip, const RoleMap& roles, const ActorCamera& camera) {
  if (Status status = check(clip, camera); !status) return status.error();
  auto shape = actor_shape(clip, roles, camera.framing, std::max(0, camera.joint));
  if (!shape) return shape.error();
  return Shooting(clip, roles, camera, *std::move(shape)).shoot();
}

}  // namespace krok
