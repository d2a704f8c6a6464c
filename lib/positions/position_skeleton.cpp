#include "positions/position_skeleton.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/index.h"
#include "core/text.h"

namespace krok {

namespace {

// NAME<PARENT, NAME<PARENT@ROLE, NAME<PARENT=A+B for the mean of two columns.
#define KROK_SMPL_BODY                                                               \
  "pelvis left_hip<pelvis right_hip<pelvis spine1<pelvis left_knee<left_hip "        \
  "right_knee<right_hip spine2<spine1 left_ankle<left_knee right_ankle<right_knee "  \
  "spine3<spine2 left_foot<left_ankle right_foot<right_ankle neck<spine3 "           \
  "left_collar<spine3 right_collar<spine3 head<neck left_shoulder<left_collar "      \
  "right_shoulder<right_collar left_elbow<left_shoulder right_elbow<right_shoulder " \
  "left_wrist<left_elbow right_wrist<right_elbow "
#define KROK_SMPL_FINGER(side, finger)                                                          \
  side "_" finger "1<" side "_wrist " side "_" finger "2<" side "_" finger "1 " side "_" finger \
       "3<" side "_" finger "2 "
#define KROK_SMPL_HAND(side)                                                                      \
  KROK_SMPL_FINGER(side, "index")                                                                 \
  KROK_SMPL_FINGER(side, "middle") KROK_SMPL_FINGER(side, "pinky") KROK_SMPL_FINGER(side, "ring") \
      KROK_SMPL_FINGER(side, "thumb")
#define KROK_SOMA_FINGER(side, finger)                                                       \
  side "Hand" finger "1<" side "Hand " side "Hand" finger "2<" side "Hand" finger "1 " side  \
       "Hand" finger "3<" side "Hand" finger "2 " side "Hand" finger "4<" side "Hand" finger \
       "3 " side "Hand" finger "End<" side "Hand" finger "4 "
#define KROK_SOMA_ARM(side)                                                            \
  side "Shoulder<Chest " side "Arm<" side "Shoulder " side "ForeArm<" side "Arm " side \
       "Hand<" side "ForeArm "
#define KROK_SOMA_HAND(side)                                                                    \
  side "HandThumb1<" side "Hand " side "HandThumb2<" side "HandThumb1 " side "HandThumb3<" side \
       "HandThumb2 " side "HandThumbEnd<" side "HandThumb3 " KROK_SOMA_FINGER(side, "Index")    \
           KROK_SOMA_FINGER(side, "Middle") KROK_SOMA_FINGER(side, "Ring")                      \
               KROK_SOMA_FINGER(side, "Pinky")
#define KROK_SOMA_LEG(side) \
  side "Leg<Hips " side "Shin<" side "Leg " side "Foot<" side "Shin " side "ToeBase<" side "Foot "
#define KROK_SOMA_TRUNK \
  "Hips Spine1<Hips Spine2<Spine1 Chest<Spine2 Neck1<Chest Neck2<Neck1 Head<Neck2 "
#define KROK_G1_LEG(side)                                                                  \
  side "_hip_pitch_skel<pelvis_skel@helper " side "_hip_roll_skel<" side                   \
       "_hip_pitch_skel@helper " side "_hip_yaw_skel<" side "_hip_roll_skel@" side         \
       "_upper_leg " side "_knee_skel<" side "_hip_yaw_skel@" side "_lower_leg " side      \
       "_ankle_pitch_skel<" side "_knee_skel@" side "_foot " side "_ankle_roll_skel<" side \
       "_ankle_pitch_skel@helper " side "_toe_base<" side "_ankle_roll_skel@" side "_toes "
#define KROK_G1_ARM(side)                                                                         \
  side "_shoulder_pitch_skel<waist_pitch_skel@helper " side "_shoulder_roll_skel<" side           \
       "_shoulder_pitch_skel@helper " side "_shoulder_yaw_skel<" side "_shoulder_roll_skel@" side \
       "_upper_arm " side "_elbow_skel<" side "_shoulder_yaw_skel@" side "_lower_arm " side       \
       "_wrist_roll_skel<" side "_elbow_skel@helper " side "_wrist_pitch_skel<" side              \
       "_wrist_roll_skel@helper " side "_wrist_yaw_skel<" side "_wrist_pitch_skel@" side          \
       "_hand " side "_hand_roll_skel<" side "_wrist_yaw_skel@" side "_fingers "

struct Named {
  std::string_view name;
  double rate;
  std::string_view joints;
};

constexpr Named
    kNamed
        [] =
            {
                // smplx's joint_names.py (vchoutas/smplx): SMPL-H's order is that of SMPL without
                // the hands'
                // joints 22 and 23, then the fingers.
                {"smpl22", 0, KROK_SMPL_BODY},
                {"smpl24", 0, KROK_SMPL_BODY "left_hand<left_wrist right_hand<right_wrist"},
                {"smplh52", 0, KROK_SMPL_BODY KROK_SMPL_HAND("left") KROK_SMPL_HAND("right")},
                {"smplx55", 0,
                 KROK_SMPL_BODY
                 "jaw<head@helper left_eye<head@helper right_eye<head@helper " KROK_SMPL_HAND(
                     "left") KROK_SMPL_HAND("right")},
                // EricGuo5513/HumanML3D: SMPL's body at 20 frames per second; README and
                // paramUtil.py.
                {"humanml22", 20, KROK_SMPL_BODY},
                // KIT Motion-Language: the joints of the Master Motor Map, as in HumanML3D's
                // paramUtil.py (tree)
                // and Mathux/TEMOS (names).
                {"kit21", 12.5,
                 "root@hips BP<root@spine BT<BP@spine BLN<BT@chest BUN<BLN@head "
                 "LS<BLN@left_upper_arm "
                 "LE<LS@left_lower_arm LW<LE@left_hand RS<BLN@right_upper_arm "
                 "RE<RS@right_lower_arm "
                 "RW<RE@right_hand LH<root@left_upper_leg LK<LH@left_lower_leg LA<LK@left_foot "
                 "LMrot<LA@left_toes LF<LMrot@left_toes RH<root@right_upper_leg "
                 "RK<RH@right_lower_leg "
                 "RA<RK@right_foot RMrot<RA@right_toes RF<RMrot@right_toes"},
                // Human3.6M, the 17 joints of una-dinosauria/3d-pose-baseline,
                // facebookresearch/VideoPose3D.
                {"h36m17", 50,
                 "hips right_hip<hips right_knee<right_hip right_ankle<right_knee left_hip<hips "
                 "left_knee<left_hip left_ankle<left_knee spine<hips thorax<spine@chest "
                 "neck<thorax head<neck "
                 "left_shoulder<thorax left_elbow<left_shoulder left_wrist<left_elbow "
                 "right_shoulder<thorax "
                 "right_elbow<right_shoulder right_wrist<right_elbow"},
                // COCO's keypoints (cocodataset.org). It has neither hips nor neck: means of both
                // sides.
                {"coco17", 0,
                 "nose<neck@head left_eye<nose@helper right_eye<nose@helper left_ear<nose@helper "
                 "right_ear<nose@helper left_shoulder<neck@left_upper_arm "
                 "right_shoulder<neck@right_upper_arm "
                 "left_elbow<left_shoulder right_elbow<right_shoulder left_wrist<left_elbow "
                 "right_wrist<right_elbow left_hip<hips right_hip<hips left_knee<left_hip "
                 "right_knee<right_hip "
                 "left_ankle<left_knee right_ankle<right_knee hips=left_hip+right_hip "
                 "neck<hips=left_shoulder+right_shoulder"},
                // MediaPipe's BlazePose landmarks (ai.google.dev/edge/mediapipe, pose landmarker).
                {"mediapipe33", 30,
                 "nose<neck@head left_eye_inner<nose@helper left_eye<nose@helper "
                 "left_eye_outer<nose@helper "
                 "right_eye_inner<nose@helper right_eye<nose@helper right_eye_outer<nose@helper "
                 "left_ear<nose@helper right_ear<nose@helper mouth_left<nose@helper "
                 "mouth_right<nose@helper "
                 "left_shoulder<neck@left_upper_arm right_shoulder<neck@right_upper_arm "
                 "left_elbow<left_shoulder right_elbow<right_shoulder left_wrist<left_elbow "
                 "right_wrist<right_elbow left_pinky<left_wrist@left_little_1 "
                 "right_pinky<right_wrist@right_little_1 left_index<left_wrist@left_index_1 "
                 "right_index<right_wrist@right_index_1 left_thumb<left_wrist@left_thumb_1 "
                 "right_thumb<right_wrist@right_thumb_1 left_hip<hips right_hip<hips "
                 "left_knee<left_hip "
                 "right_knee<right_hip left_ankle<left_knee right_ankle<right_knee "
                 "left_heel<left_ankle@helper "
                 "right_heel<right_ankle@helper left_foot_index<left_ankle@left_toes "
                 "right_foot_index<right_ankle@right_toes hips=left_hip+right_hip "
                 "neck<hips=left_shoulder+right_shoulder"},
                // OptiTrack Motive's skeleton of 21 bones as NatNet streams and exports it.
                {"optitrack21", 120,
                 "Hip@hips Ab<Hip@spine Chest<Ab Neck<Chest Head<Neck LShoulder<Chest@left_collar "
                 "LUArm<LShoulder@left_upper_arm LFArm<LUArm@left_lower_arm LHand<LFArm@left_hand "
                 "RShoulder<Chest@right_collar RUArm<RShoulder@right_upper_arm "
                 "RFArm<RUArm@right_lower_arm "
                 "RHand<RFArm@right_hand LThigh<Hip@left_upper_leg LShin<LThigh@left_lower_leg "
                 "LFoot<LShin@left_foot RThigh<Hip@right_upper_leg RShin<RThigh@right_lower_leg "
                 "RFoot<RShin@right_foot LToe<LFoot@left_toes RToe<RFoot@right_toes"},
                // nv-tlabs/kimodo, kimodo/skeleton/definitions.py.
                {
                    "soma30", 30,
                    KROK_SOMA_TRUNK
                    "Jaw<Head@helper LeftEye<Head@helper RightEye<Head@helper " KROK_SOMA_ARM(
                        "Left") "LeftHandThumbEnd<LeftHand "
                                "LeftHandMiddleEnd<LeftHand " KROK_SOMA_ARM("Right") "RightHandThum"
                                                                                     "bEnd<"
                                                                                     "RightHand "
                                                                                     "RightHandMidd"
                                                                                     "leEnd<"
                                                                                     "RightHand"
                                                                                     " " KROK_SOMA_LEG("Left")
                                                                                         KROK_SOMA_LEG(
                                                                                             "Righ"
                                                                                             "t")},
                {"soma77", 30,
                 KROK_SOMA_TRUNK "HeadEnd<Head@helper Jaw<Head@helper LeftEye<Head@helper "
                                 "RightEye<Head@helper " KROK_SOMA_ARM("Left") KROK_SOMA_HAND(
                                     "Left") KROK_SOMA_ARM("Right") KROK_SOMA_HAND("Right")
                                     KROK_SOMA_LEG("Left") "LeftToeEnd<LeftToeBase " KROK_SOMA_LEG(
                                         "Right") "RightToeEnd<RightToeBase"},
                {"g1_34", 30,
                 "pelvis_skel@hips " KROK_G1_LEG("left") KROK_G1_LEG(
                     "right") "waist_yaw_skel<pelvis_skel@spine "
                              "waist_roll_skel<waist_yaw_skel@spine "
                              "waist_pitch_skel<waist_roll_skel@chest " KROK_G1_ARM("left")
                                  KROK_G1_ARM("right")}};

PositionJoint parse_joint(std::string_view word) {
  PositionJoint joint;
  const auto part_after = [&](char mark) {
    const std::size_t place = word.rfind(mark);
    if (place == std::string_view::npos) return std::string_view();
    const std::string_view part = word.substr(place + 1);
    word = word.substr(0, place);
    return part;
  };
  joint.role = part_after('@');
  for (std::string_view mean = part_after('='); !mean.empty();) {
    const std::size_t end = std::min(mean.find('+'), mean.size());
    joint.mean_of.emplace_back(mean.substr(0, end));
    mean.remove_prefix(std::min(end + 1, mean.size()));
  }
  joint.parent = part_after('<');
  joint.name = word;
  return joint;
}

// Where a joint of a role is from its parent in a T-pose facing +Z; zero if unknown. Metres for a
// height of 1.72 m: Drillis and Contini, "Body segment parameters", New York University 1966, table
// in D. Winter, "Biomechanics and Motor Control of Human Movement".
Vec3 usual_offset(Role role, FingerJoint finger, Role parent, bool first) {
  constexpr double kHeight = 1.72;
  const auto out = [&](double share) { return Vec3(share * kHeight, 0, 0); };
  Vec3 offset = Vec3::Zero();
  bool right = false;
  switch (role) {
    case Role::spine:
    case Role::chest:
      return {0, 0.12, 0};
    case Role::neck:
      return {0, parent == Role::neck ? 0.06 : 0.2, 0};
    case Role::head:
      return parent == Role::neck ? Vec3(0, 0.1, 0.03) : Vec3(0, 0.3, 0.03);
    case Role::right_collar:
      right = true;
      [[fallthrough]];
    case Role::left_collar:
      offset = {0.07, 0.12, 0};
      break;
    case Role::right_upper_arm:
      right = true;
      [[fallthrough]];
    case Role::left_upper_arm:
      offset = parent == Role::neck ? Vec3(0.129 * kHeight, -0.03, 0)
               : parent == Role::left_collar || parent == Role::right_collar
                   ? Vec3(0.129 * kHeight - 0.07, 0.02, 0)
                   : Vec3(0.129 * kHeight, 0.14, 0);
      break;
    case Role::right_lower_arm:
      right = true;
      [[fallthrough]];
    case Role::left_lower_arm:
      offset = out(0.186);
      break;
    case Role::right_hand:
      right = true;
      [[fallthrough]];
    case Role::left_hand:
      offset = out(0.146);
      break;
    case Role::right_fingers:
      right = true;
      [[fallthrough]];
    case Role::left_fingers:
      offset = Vec3(first ? 0.09 : 0.03, 0, 0);
      if (finger.finger == Finger::thumb) offset = {0.03, -0.01, 0.03};
      if (first && finger.finger == Finger::index) offset = {0.09, 0, 0.025};
      if (first && finger.finger == Finger::ring) offset = {0.085, 0, -0.02};
      if (first && finger.finger == Finger::little) offset = {0.08, 0, -0.035};
      break;
    case Role::right_upper_leg:
      right = true;
      [[fallthrough]];
    case Role::left_upper_leg:
      offset = {0.05 * kHeight, -0.06, 0};
      break;
    case Role::right_lower_leg:
    case Role::left_lower_leg:
      return {0, -0.245 * kHeight, 0};
    case Role::right_foot:
    case Role::left_foot:
      return {0, -0.246 * kHeight, 0};
    case Role::right_toes:
    case Role::left_toes:
      return first ? Vec3(0, -0.05, 0.13) : Vec3(0, 0, 0.06);
    case Role::none:
    case Role::root:
    case Role::hips:
    case Role::end:
    case Role::helper:
      return offset;
  }
  if (right) offset.x() = -offset.x();
  return offset;
}

Error at_joint(std::string code, std::string message, const std::string& joint) {
  Error error(std::move(code), std::move(message),
              "give each joint a name of its own and a parent");
  error.joint = joint;
  return error;
}

}  // namespace

int PositionSkeleton::columns() const {
  return static_cast<int>(
      std::ranges::count_if(joints, [](const PositionJoint& j) { return j.mean_of.empty(); }));
}

std::optional<PositionSkeleton> named_skeleton(std::string_view name) {
  if (name == "optitrack") name = "optitrack21";
  const auto found = std::ranges::find(kNamed, name, &Named::name);
  if (found == std::end(kNamed)) return std::nullopt;
  PositionSkeleton skeleton;
  skeleton.rate = found->rate;
  for (std::string_view rest = found->joints; !rest.empty();) {
    const std::size_t end = std::min(rest.find(' '), rest.size());
    if (end > 0) skeleton.joints.push_back(parse_joint(rest.substr(0, end)));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return skeleton;
}

std::vector<std::string> skeleton_names() {
  std::vector<std::string> names;
  for (const Named& named : kNamed) names.emplace_back(named.name);
  return names;
}

std::string_view skeleton_of_columns(std::size_t columns) {
  std::string_view found;
  for (const Named& named : kNamed) {
    if (named.name == "smpl22") continue;  // the same as humanml22
    if (at(named_skeleton(named.name)->columns()) != columns) continue;
    if (!found.empty()) return {};
    found = named.name;
  }
  return found;
}

Result<ArrangedSkeleton> arrange(const PositionSkeleton& joints) {
  ArrangedSkeleton arranged;
  Skeleton& skeleton = arranged.skeleton;
  std::vector<std::string> column_names;
  for (const PositionJoint& joint : joints.joints) {
    if (joint.mean_of.empty()) column_names.push_back(joint.name);
  }
  std::vector<GivenRole> given;
  std::vector<char> added(joints.joints.size(), 0);
  for (bool more = true; more;) {
    more = false;
    for (std::size_t i = 0; i < added.size(); ++i) {
      const PositionJoint& joint = joints.joints[i];
      const int parent = joint.parent.empty() ? Skeleton::kNoParent : skeleton.find(joint.parent);
      if (added[i] != 0 || (parent < 0 && !joint.parent.empty())) continue;
      if (parent < 0 && !skeleton.empty()) {
        return at_joint(
            "skeleton-parent",
            fmt::format("{} and {} have no parent", shown(skeleton.names[0]), shown(joint.name)),
            joint.name);
      }
      if (joint.name.empty() || skeleton.find(joint.name) >= 0) {
        return at_joint("skeleton-name", fmt::format("two joints are named {}", shown(joint.name)),
                        joint.name);
      }
      more = true;
      added[i] = 1;
      if (auto role = joint.role.empty() ? std::nullopt : parse_role_label(joint.role)) {
        role->joint = skeleton.joint_count();
        given.push_back(*role);
      }
      std::vector<int>& columns = arranged.columns.emplace_back();
      for (const std::string& name :
           joint.mean_of.empty() ? std::vector{joint.name} : joint.mean_of) {
        const auto column = std::ranges::find(column_names, name);
        if (column == column_names.end()) {
          return at_joint("skeleton-parent", fmt::format("there is no column {}", shown(name)),
                          joint.name);
        }
        columns.push_back(static_cast<int>(column - column_names.begin()));
      }
      skeleton.add(joint.name, parent, Transform{});
    }
  }
  for (std::size_t i = 0; i < added.size(); ++i) {
    if (added[i] != 0) continue;
    return at_joint("skeleton-parent",
                    fmt::format("the parent {} of {} is not there, or below it",
                                shown(joints.joints[i].parent), shown(joints.joints[i].name)),
                    joints.joints[i].name);
  }
  auto roles = find_roles(skeleton, given);
  if (!roles) return roles.error();
  arranged.roles = *std::move(roles);
  for (std::size_t j = 1; j < skeleton.names.size(); ++j) {
    const std::size_t parent = at(skeleton.parents[j]);
    const Role role = arranged.roles.roles[j], above = arranged.roles.roles[parent];
    skeleton.reference[j].position =
        skeleton.reference[parent].position +
        usual_offset(role, arranged.roles.fingers[j], above, above != role);
  }
  return arranged;
}

std::vector<Vec3> places_of(const ArrangedSkeleton& skeleton, std::span<const Vec3> columns,
                            std::size_t column_count) {
  std::vector<Vec3> places;
  const std::size_t frames = column_count == 0 ? 0 : columns.size() / column_count;
  places.reserve(frames * skeleton.columns.size());
  for (std::size_t f = 0; f < frames; ++f) {
    for (const std::vector<int>& from : skeleton.columns) {
      Vec3 sum = Vec3::Zero();
      for (const int column : from) sum += columns[f * column_count + at(column)];
      places.push_back(sum / static_cast<double>(from.size()));
    }
  }
  return places;
}

}  // namespace krok
