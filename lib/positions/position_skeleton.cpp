#include "positions/position_skeleton.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/index.h"
#include "core/text.h"

namespace krok {

namespace {

// Joints in the order of the array: NAME<PARENT, NAME<PARENT@ROLE, NAME<PARENT=A+B for the mean of
// two columns. A word with * stands for left and right, (#A|B: WORDS) for the words with A for #,
// then with B; +NAME for the joints of another skeleton.
struct Named {
  std::string_view name;
  double rate;
  std::string_view joints;
};

constexpr Named kNamed[] = {
    // smplx's joint_names.py (vchoutas/smplx): SMPL-H's order is that of SMPL without the hands'
    // joints 22 and 23, then the fingers.
    {"smpl22", 0, R"(pelvis *_hip<pelvis spine1<pelvis *_knee<*_hip spine2<spine1 *_ankle<*_knee
        spine3<spine2 *_foot<*_ankle neck<spine3 *_collar<spine3 head<neck *_shoulder<*_collar
        *_elbow<*_shoulder *_wrist<*_elbow)"},
    {"smpl24", 0, "+smpl22 *_hand<*_wrist"},
    {"smplh52", 0, R"(+smpl22 (*left|right:(#index|middle|pinky|ring|thumb:
        *_#1<*_wrist *_#2<*_#1 *_#3<*_#2)))"},
    {"smplx55", 0, R"(+smpl22 jaw<head@helper *_eye<head@helper
        (*left|right:(#index|middle|pinky|ring|thumb:*_#1<*_wrist *_#2<*_#1 *_#3<*_#2)))"},
    // EricGuo5513/HumanML3D: SMPL's body at 20 frames per second; README and paramUtil.py.
    {"humanml22", 20, "+smpl22"},
    // KIT Motion-Language: the joints of the Master Motor Map, as in HumanML3D's paramUtil.py
    // (tree) and Mathux/TEMOS (names).
    {"kit21", 12.5, R"(root@hips BP<root@spine BT<BP@spine BLN<BT@chest BUN<BLN@head
        LS<BLN@left_upper_arm LE<LS@left_lower_arm LW<LE@left_hand
        RS<BLN@right_upper_arm RE<RS@right_lower_arm RW<RE@right_hand
        LH<root@left_upper_leg LK<LH@left_lower_leg LA<LK@left_foot LMrot<LA@left_toes
        LF<LMrot@left_toes RH<root@right_upper_leg RK<RH@right_lower_leg RA<RK@right_foot
        RMrot<RA@right_toes RF<RMrot@right_toes)"},
    // Human3.6M, the 17 joints of una-dinosauria/3d-pose-baseline, facebookresearch/VideoPose3D.
    {"h36m17", 50, R"(hips (*right|left:*_hip<hips *_knee<*_hip *_ankle<*_knee) spine<hips
        thorax<spine@chest neck<thorax head<neck
        (*left|right:*_shoulder<thorax *_elbow<*_shoulder *_wrist<*_elbow))"},
    // COCO's keypoints (cocodataset.org). It has no hips, neck and head: means of both sides.
    {"coco17", 0, R"(nose<head@helper *_eye<head@helper *_ear<head@helper
        *_shoulder<neck@*_upper_arm *_elbow<*_shoulder *_wrist<*_elbow *_hip<hips *_knee<*_hip
        *_ankle<*_knee hips=left_hip+right_hip neck<hips=left_shoulder+right_shoulder
        head<neck=left_ear+right_ear)"},
    // MediaPipe's BlazePose landmarks (ai.google.dev/edge/mediapipe, pose landmarker).
    {"mediapipe33", 30, R"(nose<head@helper
        (*left|right:*_eye_inner<head@helper *_eye<head@helper *_eye_outer<head@helper)
        *_ear<head@helper mouth_*<head@helper *_shoulder<neck@*_upper_arm *_elbow<*_shoulder
        *_wrist<*_elbow *_pinky<*_wrist@*_little_1 *_index<*_wrist@*_index_1
        *_thumb<*_wrist@*_thumb_1 *_hip<hips *_knee<*_hip *_ankle<*_knee *_heel<*_ankle@helper
        *_foot_index<*_ankle@*_toes hips=left_hip+right_hip
        neck<hips=left_shoulder+right_shoulder head<neck=left_ear+right_ear)"},
    // OptiTrack Motive's skeleton of 21 bones as NatNet streams and exports it.
    {"optitrack21", 120, R"(Hip@hips Ab<Hip@spine Chest<Ab Neck<Chest Head<Neck
        LShoulder<Chest@left_collar LUArm<LShoulder@left_upper_arm LFArm<LUArm@left_lower_arm
        LHand<LFArm@left_hand RShoulder<Chest@right_collar RUArm<RShoulder@right_upper_arm
        RFArm<RUArm@right_lower_arm RHand<RFArm@right_hand LThigh<Hip@left_upper_leg
        LShin<LThigh@left_lower_leg LFoot<LShin@left_foot RThigh<Hip@right_upper_leg
        RShin<RThigh@right_lower_leg RFoot<RShin@right_foot LToe<LFoot@left_toes
        RToe<RFoot@right_toes)"},
    // nv-tlabs/kimodo, kimodo/skeleton/definitions.py.
    {"soma30", 30, R"(Hips Spine1<Hips Spine2<Spine1 Chest<Spine2 Neck1<Chest Neck2<Neck1 Head<Neck2
        Jaw<Head@helper LeftEye<Head@helper RightEye<Head@helper
        (*Left|Right:*Shoulder<Chest *Arm<*Shoulder *ForeArm<*Arm *Hand<*ForeArm
          *HandThumbEnd<*Hand *HandMiddleEnd<*Hand)
        (*Left|Right:*Leg<Hips *Shin<*Leg *Foot<*Shin *ToeBase<*Foot))"},
    {"soma77", 30, R"(Hips Spine1<Hips Spine2<Spine1 Chest<Spine2 Neck1<Chest Neck2<Neck1 Head<Neck2
        HeadEnd<Head@helper Jaw<Head@helper LeftEye<Head@helper RightEye<Head@helper
        (*Left|Right:*Shoulder<Chest *Arm<*Shoulder *ForeArm<*Arm *Hand<*ForeArm
          *HandThumb1<*Hand *HandThumb2<*HandThumb1 *HandThumb3<*HandThumb2
          *HandThumbEnd<*HandThumb3 (#Index|Middle|Ring|Pinky:*Hand#1<*Hand *Hand#2<*Hand#1
            *Hand#3<*Hand#2 *Hand#4<*Hand#3 *Hand#End<*Hand#4))
        (*Left|Right:*Leg<Hips *Shin<*Leg *Foot<*Shin *ToeBase<*Foot *ToeEnd<*ToeBase))"},
    {"g1_34", 30, R"(pelvis_skel@hips
        (*left|right:*_hip_pitch_skel<pelvis_skel@helper *_hip_roll_skel<*_hip_pitch_skel@helper
          *_hip_yaw_skel<*_hip_roll_skel@*_upper_leg *_knee_skel<*_hip_yaw_skel@*_lower_leg
          *_ankle_pitch_skel<*_knee_skel@*_foot *_ankle_roll_skel<*_ankle_pitch_skel@helper
          *_toe_base<*_ankle_roll_skel@*_toes)
        waist_yaw_skel<pelvis_skel@spine waist_roll_skel<waist_yaw_skel@spine
        waist_pitch_skel<waist_roll_skel@chest
        (*left|right:*_shoulder_pitch_skel<waist_pitch_skel@helper
          *_shoulder_roll_skel<*_shoulder_pitch_skel@helper
          *_shoulder_yaw_skel<*_shoulder_roll_skel@*_upper_arm
          *_elbow_skel<*_shoulder_yaw_skel@*_lower_arm *_wrist_roll_skel<*_elbow_skel@helper
          *_wrist_pitch_skel<*_wrist_roll_skel@helper *_wrist_yaw_skel<*_wrist_pitch_skel@*_hand
          *_hand_roll_skel<*_wrist_yaw_skel@*_fingers))"}};

const Named* find_named(std::string_view name) {
  const auto found =
      std::ranges::find(kNamed, name == "optitrack" ? "optitrack21" : name, &Named::name);
  return found == std::end(kNamed) ? nullptr : found;
}

void add_words(std::string_view text, std::vector<std::string>& words) {
  // For each of the names between bars.
  const auto add_each = [&](std::string_view names, char mark, std::string_view with) {
    while (!names.empty()) {
      const std::size_t end = std::min(names.find('|'), names.size());
      std::string one;
      for (const char c : with) {
        c == mark ? one.append(names.substr(0, end)) : one.append(1, c);
      }
      add_words(one, words);
      names.remove_prefix(std::min(end + 1, names.size()));
    }
  };
  while (!(text = trimmed(text)).empty()) {
    std::size_t end = 0;
    if (text.front() == '(') {
      for (int depth = 0; end == 0 || depth > 0; ++end) {
        depth += text[end] == '(' ? 1 : text[end] == ')' ? -1 : 0;
      }
      const std::size_t colon = text.find(':');
      add_each(text.substr(2, colon - 2), text[1], text.substr(colon + 1, end - colon - 2));
    } else {
      end = std::min(text.find_first_of(" \n"), text.size());
      const std::string_view word = text.substr(0, end);
      if (word.front() == '+') {
        add_words(find_named(word.substr(1))->joints, words);
      } else if (word.find('*') != std::string_view::npos) {
        add_each("left|right", '*', word);
      } else {
        words.emplace_back(word);
      }
    }
    text.remove_prefix(end);
  }
}

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

// The role on the left side, for one on the right.
Role left_of(Role role) {
  const auto number = [](Role of) { return static_cast<int>(of); };
  int back = 0;
  if (role >= Role::right_collar && role <= Role::right_fingers) {
    back = number(Role::right_collar) - number(Role::left_collar);
  } else if (role >= Role::right_upper_leg && role <= Role::right_toes) {
    back = number(Role::right_upper_leg) - number(Role::left_upper_leg);
  }
  return static_cast<Role>(number(role) - back);
}

// Where a joint of a role is from its parent in a T-pose facing +Z; zero if unknown. Metres for a
// height of 1.72 m: Drillis and Contini, "Body segment parameters", New York University 1966, table
// in D. Winter, "Biomechanics and Motor Control of Human Movement".
Vec3 usual_offset(Role role, FingerJoint finger, Role parent, bool first) {
  constexpr double kHeight = 1.72;
  if (left_of(role) != role) {
    const Vec3 left = usual_offset(left_of(role), finger, left_of(parent), first);
    return {-left.x(), left.y(), left.z()};
  }
  switch (role) {
    case Role::spine:
    case Role::chest:
      return {0, 0.12, 0};
    case Role::neck:
      return {0, parent == Role::neck ? 0.06 : 0.2, 0};
    case Role::head:
      return parent == Role::neck ? Vec3(0, 0.1, 0.03) : Vec3(0, 0.3, 0.03);
    case Role::left_collar:
      return {0.07, 0.12, 0};
    case Role::left_upper_arm:
      if (parent == Role::neck) return {0.129 * kHeight, -0.03, 0};
      if (parent == Role::left_collar) return {0.129 * kHeight - 0.07, 0.02, 0};
      return {0.129 * kHeight, 0.14, 0};
    case Role::left_lower_arm:
      return {0.186 * kHeight, 0, 0};
    case Role::left_hand:
      return {0.146 * kHeight, 0, 0};
    case Role::left_fingers:
      if (finger.finger == Finger::thumb) return {0.03, -0.01, 0.03};
      if (!first) return {0.03, 0, 0};
      if (finger.finger == Finger::index) return {0.09, 0, 0.025};
      if (finger.finger == Finger::ring) return {0.085, 0, -0.02};
      if (finger.finger == Finger::little) return {0.08, 0, -0.035};
      return {0.09, 0, 0};
    case Role::left_upper_leg:
      return {0.05 * kHeight, -0.06, 0};
    case Role::left_lower_leg:
      return {0, -0.245 * kHeight, 0};
    case Role::left_foot:
      return {0, -0.246 * kHeight, 0};
    case Role::left_toes:
      return first ? Vec3(0, -0.05, 0.13) : Vec3(0, 0, 0.06);
    default:
      return Vec3::Zero();
  }
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
  const Named* const named = find_named(name);
  if (named == nullptr) return std::nullopt;
  PositionSkeleton skeleton;
  skeleton.rate = named->rate;
  std::vector<std::string> words;
  add_words(named->joints, words);
  for (const std::string& word : words) skeleton.joints.push_back(parse_joint(word));
  return skeleton;
}

std::vector<std::string> skeleton_names() {
  std::vector<std::string> names;
  for (const Named& named : kNamed) names.emplace_back(named.name);
  return names;
}

std::vector<std::string_view> skeletons_of_columns(std::size_t columns) {
  static const auto counts = [] {
    std::array<std::size_t, std::size(kNamed)> all;
    std::ranges::transform(kNamed, all.begin(),
                           [](const Named& n) { return at(named_skeleton(n.name)->columns()); });
    return all;
  }();
  std::vector<std::string_view> found;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    // smpl22 is the same as humanml22.
    if (counts[i] == columns && kNamed[i].name != "smpl22") found.push_back(kNamed[i].name);
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

}  // namespace krok
