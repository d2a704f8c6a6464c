#include "camera/actor_camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "camera/look_at.h"
#include "core/index.h"
#include "motion/hips_root.h"
#include "roles/body_frame.h"

namespace krok {

namespace {

constexpr double kFarthest = 1e4;  // metres
constexpr int kMaxTries = 500;
constexpr double kCloseEnough = 0.999;  // fraction of a distance that works
constexpr double kLargestMargin = 0.45;
constexpr double kFastestTurn = 90 * kRadiansPerDegree;      // a second, with the actor's facing
constexpr double kMoreSmoothing = 1.25, kMaxSmoothing = 20;  // factor, seconds

Status check(const FrameSource& clip, const ActorCamera& camera) {
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

// The camera's positions and directions while its distance is searched. Frames are read in a few
// passes, and none is kept.
class Shooting {
 public:
  Shooting(const FrameSource& source, const RoleMap& roles, const ActorCamera& camera,
           ActorShape shape, int jobs)
      : source_(source),
        camera_(camera),
        shape_(std::move(shape)),
        jobs_(jobs),
        frames_(source.frame_count),
        feet_(foot_joints(source.skeleton, roles)),
        carrier_(carrying_joint(roles)),
        front_(front_of(source.skeleton, roles)),
        wanted_(ImageExtent::of(camera.field_of_view, camera.aspect, camera.margin)),
        edges_(ImageExtent::of(camera.field_of_view, camera.aspect, 0)) {}

  Result<ActorShot> shoot() {
    if (Status status = look(); !status) return status.error();
    const bool still =
        camera_.joint < 0 && camera_.turning == 0 && camera_.azimuth_from != AzimuthFrom::actor;
    if (still && !camera_.distance) {
      const auto clear = stand_still();
      if (!clear) return clear.error();
      if (*clear) return result();
    }
    if (camera_.distance) {
      place(*camera_.distance);
      if (Status status = measure(true); !status) return status.error();
      return result();
    }
    const auto found = find_distance();
    if (!found) return found.error();
    if (!*found) {
      return Error("camera-frame", "no camera position within 10 km shows everything to be framed",
                   "check the motion for stray joints; --frame or --map can exclude them");
    }
    return result();
  }

 private:
  // Calls use(frame, block, frame in the block) for all frames in order.
  template <typename Use>
  Status for_frames(const Use& use) const {
    return for_each_block(source_, jobs_, [&](int first, const Clip& block) {
      for (int f = 0; f < block.frame_count(); ++f) use(first + f, block, f);
      return Status();
    });
  }

  // The ground, the azimuth and the point the camera looks at in each frame.
  Status look() {
    ground_ = std::numeric_limits<double>::infinity();
    std::vector<Vec3> headings;  // as x, to use the same smoothing as for the path
    Box whole;
    double above = 0, start = 0;
    const bool turns = camera_.azimuth_from == AzimuthFrom::actor;
    if (turns) headings.reserve(at(frames_));
    path_.reserve(at(frames_));
    Status status = for_frames([&](int frame, const Clip& block, int f) {
      const auto places = block.frame_positions(f);
      for (const int j : feet_) {
        ground_ = std::min(ground_, static_cast<double>(places[at(j)].y()));
      }
      if (turns || (frame == 0 && camera_.azimuth_from == AzimuthFrom::start)) {
        const double heading = front_ + ground_frame(block, carrier_, f).heading;
        if (frame == 0) start = heading;
        const double before = frame == 0 ? start : headings.back().x();
        if (turns) headings.emplace_back(before + wrapped(heading - before), 0, 0);
      }
      Box box;
      for (const Ball& ball : shown(block, f)) {
        box.add(ball);
        whole.add(ball);
      }
      if (camera_.joint < 0) return;
      path_.emplace_back(places[at(camera_.joint)].cast<double>());
      above += (box.middle().y() - path_.back().y()) / frames_;
    });
    if (!status) return status;
    if (turns) smooth_turning(headings);
    azimuths_.reserve(at(frames_));
    for (int f = 0; f < frames_; ++f) {
      const double heading = turns ? headings[at(f)].x() : start;
      azimuths_.push_back(heading + camera_.azimuth + camera_.turning * f / source_.rate);
    }
    if (camera_.joint < 0) {
      path_.assign(at(frames_), whole.middle());
      return {};
    }
    apply_dead_zone(camera_.dead_zone, path_);
    smooth_both_ways(path_, source_.rate, camera_.smoothing);
    for (Vec3& place : path_) place.y() += above;
    return {};
  }

  // Smooths as asked, and longer where the camera would whip round.
  void smooth_turning(std::vector<Vec3>& headings) const {
    const std::vector<Vec3> given = headings;
    for (double time = camera_.smoothing; time > 0; time *= kMoreSmoothing) {
      headings = given;
      smooth_both_ways(headings, source_.rate, time);
      double fastest = 0;
      for (std::size_t f = 1; f < headings.size(); ++f) {
        fastest = std::max(fastest, std::abs(headings[f].x() - headings[f - 1].x()) * source_.rate);
      }
      if (fastest <= kFastestTurn || time > kMaxSmoothing) return;
    }
  }

  std::span<const Ball> shown(const Clip& block, int frame) {
    balls_of(shape_, shape_.shown, block.frame_positions(frame), balls_);
    return balls_;
  }

  // All frames in one image, from as close as possible. False if that position is below the ground
  // or inside the body.
  Result<bool> stand_still() {
    const Quat direction = looking_from(azimuths_[0], camera_.elevation);
    CameraFit tight(wanted_, direction);
    Status status = for_frames([&](int, const Clip& block, int f) {
      for (const Ball& ball : shown(block, f)) tight.add(ball);
    });
    if (!status) return status.error();
    const Vec3 eye = tight.place();
    if (eye.y() < ground_ + kClearance || !eye.allFinite()) return false;
    eyes_.assign(at(frames_), eye);
    directions_.assign(at(frames_), direction);
    distance_ = (tight.nearest() + tight.farthest()) / 2;
    if (status = measure(true); !status) return status.error();
    return is_clear_;
  }

  // Places the camera in all frames, above the ground if `over_ground`.
  void place(double distance, bool over_ground = true) {
    distance_ = distance;
    eyes_.clear();
    directions_.clear();
    eyes_.reserve(at(frames_));
    directions_.reserve(at(frames_));
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

  // The distance required with the current directions; with `body`, whether the camera is clear of
  // it, and what is to be reported of this placement.
  Status measure(bool body) {
    needed_ = 0;
    is_clear_ = true;
    shot_ = {};
    return for_frames([&](int frame, const Clip& block, int f) {
      const auto balls = shown(block, f);
      const Vec3& eye = eyes_[at(frame)];
      const Quat& direction = directions_[at(frame)];
      needed_ = std::max(needed_, distance_to_frame(wanted_, direction, path_[at(frame)], balls));
      if (!body) return;
      const double away = distance_to_body(shape_, block.frame_positions(f), eye);
      if (away < kClearance) is_clear_ = false;
      if (away < kClearance - 1e-6 && ++shot_.frames_inside == 1) shot_.first_inside = frame;
      if (shows_all(edges_, eye, direction, balls)) {
        ++shot_.frames_shown;
      } else if (shot_.first_not_shown < 0) {
        shot_.first_not_shown = frame;
      }
    });
  }

  // The first result is exact if the camera is above the ground and clear of the character.
  // Otherwise the directions depend on the distance: increase it until it works, then bisect.
  Result<bool> find_distance() {
    place(1, false);
    if (Status status = measure(false); !status) return status.error();
    double distance = std::max(needed_, 1e-3);
    double failing = 0, working = 0;  // 0 for none
    for (int attempt = 0; attempt < kMaxTries && distance <= kFarthest; ++attempt) {
      place(distance);
      if (Status status = measure(true); !status) return status.error();
      const bool works = needed_ <= distance * (1 + 1e-12) && is_clear_;
      (works ? working : failing) = distance;
      if (works && (needed_ > kCloseEnough * distance || failing > kCloseEnough * distance)) {
        return true;
      }
      if (working > 0) {
        if (failing > kCloseEnough * working) break;
        distance = (failing + working) / 2;
      } else {
        distance = std::max(needed_, distance * 1.05);
      }
    }
    if (!(working > 0)) return false;
    place(working);
    if (Status status = measure(true); !status) return status.error();
    return true;
  }

  // That of the last placement measured.
  Result<ActorShot> result() {
    ActorShot shot = std::move(shot_);
    shot.distance = distance_;
    CameraTrack& track = shot.track;
    track.rate = source_.rate;
    path_ = {};
    track.positions.reserve(at(frames_));
    for (const Vec3& eye : eyes_) track.positions.emplace_back(eye.cast<float>());
    track.orientations.reserve(at(frames_));
    for (const Quat& direction : directions_) {
      track.orientations.push_back(direction.cast<float>().normalized());
    }
    track.fields_of_view.assign(at(frames_), static_cast<float>(camera_.field_of_view));
    if (Status status = krok::check(track); !status) return status.error();
    return shot;
  }

  const FrameSource& source_;
  const ActorCamera& camera_;
  ActorShape shape_;
  int jobs_, frames_;
  std::vector<int> feet_;
  int carrier_;
  double front_;
  ImageExtent wanted_, edges_;  // with the margin, and without
  double ground_ = 0, distance_ = 0;
  std::vector<double> azimuths_;
  std::vector<Vec3> path_, eyes_;
  std::vector<Quat> directions_;
  std::vector<Ball> balls_;
  double needed_ = 0;  // of measure()
  bool is_clear_ = true;
  ActorShot shot_;
};

}  // namespace

Result<ActorShot> film(const Clip& clip, const RoleMap& roles, const ActorCamera& camera) {
  return film(frames_of(clip), roles, camera, 1);
}

Result<ActorShot> film(const FrameSource& source, const RoleMap& roles, const ActorCamera& camera,
                       int jobs) {
  if (Status status = check(source, camera); !status) return status.error();
  const auto first = load(part_of(source, 0, std::min(source.frame_count, 1)), 1);
  if (!first) return first.error();
  auto shape = actor_shape(*first, roles, camera.framing, std::max(0, camera.joint));
  if (!shape) return shape.error();
  return Shooting(source, roles, camera, *std::move(shape), jobs).shoot();
}

}  // namespace krok
