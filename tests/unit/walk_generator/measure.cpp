#include "measure.h"

#include <algorithm>
#include <cmath>

namespace krok::samples::test {

const char* joint_side(Side side) {
  return side == Side::left ? "Left" : "Right";
}

std::vector<Vec3> track(const Clip& clip, const std::string& joint, const Vec3& offset) {
  const auto index = static_cast<std::size_t>(clip.skeleton.find(joint));
  std::vector<Transform> pose(clip.skeleton.names.size());
  std::vector<Vec3> places;
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    clip.get_pose(frame, pose);
    places.push_back(pose.at(index) * offset);
  }
  return places;
}

LegAngles leg_angles(const Clip& clip, Side side) {
  const std::string name = joint_side(side);
  const auto hips = track(clip, "Hips", Vec3::Zero());
  const auto before_hips = track(clip, "Hips", Vec3::UnitZ());
  const auto hip = track(clip, name + "UpLeg", Vec3::Zero());
  const auto knee = track(clip, name + "Leg", Vec3::Zero());
  const auto knee_axis = track(clip, name + "Leg", Vec3::UnitX());
  const auto ankle = track(clip, name + "Foot", Vec3::Zero());
  const auto before_ankle = track(clip, name + "Foot", Vec3::UnitZ());
  LegAngles angles;
  for (std::size_t i = 0; i < hips.size(); ++i) {
    Vec3 forward = before_hips[i] - hips[i];
    forward.y() = 0;
    forward.normalize();
    const Vec3 thigh = (knee[i] - hip[i]).normalized();
    const Vec3 shank = (ankle[i] - knee[i]).normalized();
    const Vec3 foot = before_ankle[i] - ankle[i];
    angles.hip.push_back(std::atan2(thigh.dot(forward), -thigh.y()));
    const double bend = thigh.cross(shank).dot(knee_axis[i] - knee[i]);
    angles.knee.push_back(std::atan2(bend, thigh.dot(shank)));
    angles.hyperextension = std::max(angles.hyperextension, -angles.knee.back());
    angles.ankle.push_back(std::asin(std::clamp(foot.dot(-shank), -1.0, 1.0)));
  }
  return angles;
}

}  // namespace krok::samples::test
