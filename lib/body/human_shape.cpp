#include "body/shapes.h"

#include <algorithm>

#include "body/human_parts.h"

namespace krok::body {

namespace {

// A row of a profile: position along the bone (0 to 1), half-axes and offsets over stature.
struct LimbRow {
  double at, width, depth, outward, back;
};

constexpr LimbRow kUpperArm[] = {{-0.04, 0.0300, 0.0330, 0.000, 0.000},
                                 {0.10, 0.0325, 0.0345, 0.001, 0.000},
                                 {0.28, 0.0315, 0.0335, 0.001, 0.000},
                                 {0.55, 0.0275, 0.0305, 0.000, -0.002},
                                 {0.82, 0.0235, 0.0250, 0.000, 0.000}};
constexpr LimbRow kForearm[] = {
    {0.00, 0.0230, 0.0235, 0.000, 0.000}, {0.18, 0.0250, 0.0270, 0.000, 0.000},
    {0.40, 0.0230, 0.0250, 0.000, 0.000}, {0.70, 0.0175, 0.0195, 0.000, 0.000},
    {0.93, 0.0130, 0.0165, 0.000, 0.000}, {1.00, 0.0125, 0.0165, 0.000, 0.000}};
constexpr LimbRow kThigh[] = {{0.00, 0.0450, 0.0530, 0.002, 0.002},
                              {0.15, 0.0475, 0.0550, 0.003, 0.000},
                              {0.40, 0.0430, 0.0490, 0.002, -0.003},
                              {0.70, 0.0360, 0.0400, 0.000, -0.003},
                              {0.90, 0.0310, 0.0340, 0.000, 0.000}};
constexpr LimbRow kShank[] = {
    {0.00, 0.0295, 0.0330, 0.000, 0.000}, {0.12, 0.0290, 0.0320, 0.000, 0.002},
    {0.30, 0.0325, 0.0360, 0.001, 0.008}, {0.50, 0.0285, 0.0315, 0.000, 0.008},
    {0.75, 0.0200, 0.0225, 0.000, 0.004}, {0.95, 0.0170, 0.0195, 0.000, 0.001}};

// Height over the hip joints, half-breadth, half-depth, offset forward; all over stature, the
// height for a trunk (hip joints to shoulder joints) of 0.285.
struct TrunkRow {
  double height, width, depth, forward, detail;
};
constexpr double kTrunkLength = 0.285;
constexpr TrunkRow kTrunk[] = {
    {-0.045, 0.0460, 0.0470, -0.004, 1.2}, {-0.015, 0.0760, 0.0580, -0.005, 1.3},
    {0.015, 0.0850, 0.0620, -0.005, 1.3},  {0.050, 0.0835, 0.0590, -0.003, 1.3},
    {0.085, 0.0780, 0.0555, 0.000, 1.3},   {0.120, 0.0760, 0.0545, 0.001, 1.3},
    {0.160, 0.0820, 0.0590, 0.002, 1.3},   {0.205, 0.0900, 0.0640, 0.002, 1.3},
    {0.240, 0.0930, 0.0630, -0.002, 1.3},  {0.270, 0.0830, 0.0530, -0.006, 1.2},
    {0.295, 0.0540, 0.0400, -0.009, 1.1}};

}  // namespace

HumanBuilder::HumanBuilder(const Skeleton& skeleton, const HumanActor& actor,
                           std::span<const Transform> pose)
    : skeleton_(skeleton),
      actor_(actor),
      pose_(pose),
      unit_(actor.stature),
      along_(skeleton.names.size(), 0) {
  for (std::size_t j = 1; j < along_.size(); ++j) {
    const auto parent = static_cast<std::size_t>(skeleton.parents[j]);
    along_[j] = along_[parent] + (pose[j].position - pose[parent].position).norm();
  }
}

Shape HumanBuilder::build() {
  build_trunk();
  place_head();
  build_neck();
  build_head();
  for (std::size_t side = 0; side < 2; ++side) {
    build_leg(side);
    build_foot(side);
    build_arm(side);
    build_hand(side);
  }
  join();
  return std::move(shape_);
}

// The joints of `path` along a tube that starts at `origin` and follows `axis`: arc is the distance
// along that axis, increasing from joint to joint.
std::vector<TubeJoint> HumanBuilder::joints_along(const std::vector<int>& path, const Vec3& origin,
                                                  const Vec3& axis, double half_width) const {
  std::vector<TubeJoint> joints;
  for (const int joint : path) {
    if (skeleton_.end_sites[static_cast<std::size_t>(joint)]) continue;
    double at = (position(joint) - origin).dot(axis);
    if (!joints.empty()) at = std::max(at, joints.back().at);
    joints.push_back({joint, at, half_width});
  }
  return joints;
}

void HumanBuilder::build_trunk() {
  const Vec3 hips = 0.5 * (position(actor_.legs[0].hip) + position(actor_.legs[1].hip));
  const Vec3 shoulders =
      0.5 * (position(actor_.arms[0].shoulder) + position(actor_.arms[1].shoulder));
  const double length = (shoulders - hips).norm();
  trunk_base_ = hips;
  trunk_axis_ = (shoulders - hips) / length;
  trunk_scale_ = length / (kTrunkLength * unit_);
  const double half_breadth =
      0.5 * (position(actor_.arms[0].shoulder) - position(actor_.arms[1].shoulder)).norm();
  // Narrow shoulders get a narrow chest, so that the arms do not touch it.
  chest_scale_ = std::clamp(half_breadth / (0.105 * unit_), 0.8, 1.3);
  // Hip joints far apart get wide hips and thighs, or the thighs would bulge.
  const double half_hips =
      0.5 * (position(actor_.legs[0].hip) - position(actor_.legs[1].hip)).norm();
  hip_scale_ = std::clamp((half_hips / unit_ + 0.045) / 0.097, 0.95, 1.4);

  Tube tube;
  for (const TrunkRow& row : kTrunk) {
    const double part = std::clamp((row.height - 0.10) / 0.10, 0.0, 1.0);
    // Interpolates between both at the waist.
    const double widen = 1 + part * (chest_scale_ - 1) +
                         (1 - part) * (hip_scale_ - 1) * (row.height < 0.06 ? 1.0 : 0.6);
    Station station;
    station.center = trunk_point(row.height, 0, row.forward);
    station.width = row.width * widen * unit_;
    station.depth = row.depth * unit_;
    station.cap = 0.03 * unit_;
    station.side = Vec3::UnitX();
    station.front = Vec3::UnitZ();
    station.arc = row.height * trunk_scale_ * unit_;
    station.along = along_[static_cast<std::size_t>(actor_.hips)] + std::max(0.0, station.arc);
    station.detail = row.detail;
    tube.stations.push_back(station);
  }
  tube.joints = joints_along(joint_path(skeleton_, actor_.hips, chest_joint()), trunk_base_,
                             trunk_axis_, 0.04 * unit_);
  // The part below the first spine joint follows the hips.
  trunk_ = shape_.add(std::move(tube));

  for (std::size_t side = 0; side < 2; ++side) {
    const double x = side == 0 ? 1.0 : -1.0;
    glutes_[side] =
        add_ball(trunk_point(-0.020, 0.040 * x, -0.038), {0.040, 0.033, 0.044}, 1.2, trunk_);
    chest_[side] = add_ball(trunk_point(0.224, 0.039 * x * chest_scale_, 0.040),
                            {0.042, 0.0165, 0.030}, 1.1, trunk_);
  }
}

Vec3 HumanBuilder::trunk_point(double height, double left, double forward) const {
  return trunk_base_ + trunk_axis_ * (height * trunk_scale_ * unit_) +
         Vec3(left * unit_, 0, forward * unit_);
}

// An ellipsoid with half-axes (left, forward, up) over stature that follows the joints of the trunk
// or of tube `like`.
int HumanBuilder::add_ball(const Vec3& center, const Vec3& axes, double detail, int like) {
  Tube tube;
  Station station;
  station.center = center;
  station.width = axes.x() * unit_;
  station.depth = axes.y() * unit_;
  station.cap = axes.z() * unit_;
  station.detail = detail;
  const Tube& carrier = shape_.tubes[static_cast<std::size_t>(like)];
  // The ball follows the joints at the nearest station of the carrier.
  const Station* nearest = &carrier.stations.front();
  for (const Station& s : carrier.stations) {
    if ((s.center - center).norm() < (nearest->center - center).norm()) nearest = &s;
  }
  station.arc = nearest->arc;
  station.along = nearest->along;
  tube.joints = carrier.joints;
  tube.stations.push_back(station);
  return shape_.add(std::move(tube));
}

void HumanBuilder::build_leg(std::size_t side) {
  const auto& leg = actor_.legs[side];
  const Vec3 hip = position(leg.hip), knee = position(leg.knee), ankle = position(leg.ankle);
  const double out = side == 0 ? 1.0 : -1.0;
  Tube tube;
  const double thigh = (knee - hip).norm(), shank = (ankle - knee).norm();
  const auto add = [&](const LimbRow& row, const Vec3& from, const Vec3& to, double arc) {
    Station station;
    const Vec3 bone = to - from;
    station.center = from + row.at * bone + Vec3(row.outward * out * unit_, 0, -row.back * unit_);
    station.width = row.width * unit_ * (arc > 0 ? 1.0 : 1 + (hip_scale_ - 1) * 0.6 * (1 - row.at));
    station.depth = row.depth * unit_;
    // The inside of a thigh must not cross the midline.
    const double room = out * (station.center.x() - trunk_base_.x()) - 0.004 * unit_;
    if (room < station.width) {
      const double width = std::max(0.7 * station.width, 0.5 * (room + station.width));
      station.center.x() += out * std::max(0.0, width - room);
      station.width = width;
    }
    const Vec3 down = bone.normalized();
    station.side = Vec3::UnitX() - down * down.x();
    station.front = Vec3::UnitZ();
    station.arc = arc + row.at * bone.norm();
    station.along = along_[static_cast<std::size_t>(leg.hip)] + station.arc;
    station.detail = 1.1;
    tube.stations.push_back(station);
  };
  for (const LimbRow& row : kThigh) add(row, hip, knee, 0);
  for (const LimbRow& row : kShank) add(row, knee, ankle, thigh);
  tube.joints = {{parent_outside(leg.hip), -1e9, 0}};
  const auto push = [&](int joint, double at, double half_width) {
    tube.joints.push_back({joint, std::max(at, tube.joints.back().at), half_width * unit_});
  };
  push_path(tube, leg.hip, leg.knee, hip, (knee - hip) / thigh, 0, 0.045 * unit_);
  push_path(tube, leg.knee, leg.ankle, knee, (ankle - knee) / shank, thigh, 0.035 * unit_);
  push(leg.ankle, thigh + shank, 0.022);
  legs_[side] = shape_.add(std::move(tube));
}

// Adds `from` and the joints between it and `to`, at arc + distance along `axis` from `origin`.
void HumanBuilder::push_path(Tube& tube, int from, int to, const Vec3& origin, const Vec3& axis,
                             double arc, double half_width) const {
  for (const int joint : joint_path(skeleton_, from, to)) {
    if (joint == to) break;
    const double at = arc + (position(joint) - origin).dot(axis);
    tube.joints.push_back({joint, std::max(at, tube.joints.back().at), half_width});
  }
}

void HumanBuilder::build_arm(std::size_t side) {
  const auto& arm = actor_.arms[side];
  const Vec3 shoulder = position(arm.shoulder), elbow = position(arm.elbow),
             wrist = position(arm.wrist);
  const double upper = (elbow - shoulder).norm(), lower = (wrist - elbow).norm();
  Tube tube;
  const auto add = [&](const LimbRow& row, const Vec3& from, const Vec3& to, double arc) {
    Station station;
    const Vec3 bone = to - from;
    const Vec3 along = bone.normalized();
    station.front = (Vec3::UnitZ() - along * along.z()).normalized();
    station.side = along.cross(station.front) * (side == 0 ? -1.0 : 1.0);  // up in a T-pose
    station.center =
        from + row.at * bone + (row.outward * station.side - row.back * station.front) * unit_;
    station.width = row.width * unit_;
    station.depth = row.depth * unit_;
    station.arc = arc + row.at * bone.norm();
    station.along = along_[static_cast<std::size_t>(arm.shoulder)] + station.arc;
    station.detail = 0.9;
    tube.stations.push_back(station);
  };
  for (const LimbRow& row : kUpperArm) add(row, shoulder, elbow, 0);
  for (const LimbRow& row : kForearm) add(row, elbow, wrist, upper);
  tube.joints = {{parent_outside(arm.shoulder), -1e9, 0}};
  push_path(tube, arm.shoulder, arm.elbow, shoulder, (elbow - shoulder) / upper, 0, 0.035 * unit_);
  push_path(tube, arm.elbow, arm.wrist, elbow, (wrist - elbow) / lower, upper, 0.026 * unit_);
  tube.joints.push_back({arm.wrist, std::max(upper + lower, tube.joints.back().at), 0.018 * unit_});
  arms_[side] = shape_.add(std::move(tube));

  // Trapezius and deltoid: from the neck over the collar bone to the shoulder.
  const double out = side == 0 ? 1.0 : -1.0;
  Tube ridge;
  const Vec3 inner = trunk_point(0.315, 0.018 * out, -0.008);
  const Vec3 outer = shoulder + Vec3(-0.012 * out, 0.001, -0.002) * unit_;
  for (const double t : {0.0, 0.5, 1.0}) {
    Station station;
    station.center = inner + t * (outer - inner) - Vec3(0, 0.010 * unit_ * 4 * t * (1 - t), 0);
    station.width = (0.024 + 0.004 * t) * unit_;
    station.depth = (0.026 + 0.006 * t) * unit_;
    const Vec3 along = (outer - inner).normalized();
    station.front = Vec3::UnitZ();
    station.side = along.cross(Vec3::UnitZ()) * (side == 0 ? -1.0 : 1.0);
    station.arc = (station.center - trunk_base_).x() * out;
    station.along = along_[static_cast<std::size_t>(arm.shoulder)];
    ridge.stations.push_back(station);
  }
  ridge.joints = {{chest_joint(), -1e9, 0}};
  const auto path = joint_path(skeleton_, chest_joint(), arm.shoulder);
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double at = (position(path[i]) - trunk_base_).x() * out;
    ridge.joints.push_back({path[i], std::max(at, ridge.joints.back().at), 0.03 * unit_});
  }
  ridges_[side] = shape_.add(std::move(ridge));
}

void HumanBuilder::join() {
  const double u = unit_;
  for (std::size_t side = 0; side < 2; ++side) {
    shape_.blends.push_back({{trunk_, glutes_[side], legs_[side]}, 0.035 * u});
    shape_.blends.push_back({{trunk_, ridges_[side], arms_[side], chest_[side]}, 0.035 * u});
    shape_.blends.push_back({{neck_, ridges_[side], trunk_}, 0.030 * u});
    shape_.blends.push_back({{legs_[side], feet_[side]}, 0.022 * u});
    shape_.blends.push_back({{arms_[side], palms_[side]}, 0.010 * u});
    const auto& fingers = fingers_[side];
    for (std::size_t i = 0; i < fingers.size(); ++i) {
      shape_.blends.push_back({{palms_[side], fingers[i]}, 0.008 * u});
      // A small blend between fingers, or the lattice would leave threads where they separate.
      if (i > 0) shape_.blends.push_back({{fingers[i - 1], fingers[i]}, 0.006 * u});
    }
    shape_.blends.push_back({{skull_, ears_[side]}, 0.006 * u});
  }
  shape_.blends.push_back({{skull_, face_, neck_}, 0.022 * u});
  for (const int feature : features_) {
    shape_.blends.push_back({{skull_, face_, feature}, 0.009 * u});
  }
}

Shape human_shape(const Skeleton& skeleton, const HumanActor& actor,
                  std::span<const Transform> pose) {
  return HumanBuilder(skeleton, actor, pose).build();
}

}  // namespace krok::body
