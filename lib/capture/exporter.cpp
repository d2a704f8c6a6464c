#include "capture/exporter.h"

#include <fmt/format.h>

#include <array>
#include <unordered_set>

#include "core/text.h"

namespace krok {

namespace {

struct NameSet {
  std::string_view exporter;
  std::string_view joints;  // lower case, separated by spaces; all must be present
  Confidence confidence;
  std::optional<Direction> up = {}, forward = {};
};

// The first match wins, so sets with more distinctive names come first.
constexpr std::array kNameSets = {
    NameSet{"iPi Mocap Studio, own names",
            "hip lowerspine middlespine chest lclavicle lshoulder lforearm lthigh lshin",
            Confidence::certain},
    NameSet{"a conversion of the CMU collection", "hips lhipjoint rhipjoint lowerback lthumb",
            Confidence::certain},
    NameSet{"the CMU collection's or another Acclaim skeleton",
            "lowerback thorax lfemur ltibia lhumerus lradius", Confidence::certain},
    NameSet{"Perception Neuron, or another with its names",
            "hips leftupleg leftforearm leftinhandindex rightinhandindex", Confidence::likely},
    NameSet{"Rokoko Studio", "hips spine1 leftarm leftforearm leftthigh leftshin lefttoe",
            Confidence::likely},
    NameSet{"Xsens MVN or the names it uses",
            "hips chest chest2 chest3 chest4 leftcollar leftelbow leftwrist lefthip leftknee",
            Confidence::likely},
    NameSet{"Biovision's names",
            "hips chest leftcollar leftshoulder leftelbow leftwrist lefthip leftknee leftankle",
            Confidence::likely},
    NameSet{"Biovision's names", "hips chest leftuparm leftlowarm leftupleg leftlowleg",
            Confidence::likely},
    NameSet{"OptiTrack Motive", "hip ab chest lshoulder luarm lfarm lthigh lshin",
            Confidence::certain},
    NameSet{"Daz Studio", "hip abdomenlower chestlower lthighbend lforearmbend",
            Confidence::certain},
    NameSet{"Poser or Second Life", "hip abdomen chest lcollar lshldr lforearm lthigh lshin",
            Confidence::likely},
    NameSet{"iClone or Character Creator", "cc_base_hip cc_base_l_thigh cc_base_l_upperarm",
            Confidence::certain},
    NameSet{"MakeHuman", "root upperleg01.l upperleg02.l lowerleg01.l", Confidence::certain},
    NameSet{"Unreal Engine's skeleton", "pelvis spine_01 upperarm_l lowerarm_l thigh_l calf_l",
            Confidence::likely},
    NameSet{"SMPL's skeleton", "pelvis left_hip left_knee left_ankle spine1 left_collar left_elbow",
            Confidence::certain},
    NameSet{"3ds Max Biped", "bip01 bip01_l_thigh bip01_l_calf bip01_l_upperarm",
            Confidence::certain},
    NameSet{"Kinect for Windows",
            "hipcenter shouldercenter shoulderleft elbowleft hipleft kneeleft",
            Confidence::certain},
    // Its reference pose does not stand; most of the data set's 3,076 takes begin facing z.
    NameSet{"Bandai Namco Research", "joint_root hips upperleg_l lowerleg_l toes_l upperarm_l",
            Confidence::certain, Direction::plus_y, Direction::plus_z},
    NameSet{"DeepMotion", "hips_jnt l_upleg_jnt l_leg_jnt l_arm_jnt l_forearm_jnt",
            Confidence::certain},
    NameSet{"Blender's Rigify names", "upper_arm.l forearm.l thigh.l shin.l", Confidence::likely},
};

constexpr std::string_view kMotionBuilderNames =
    "hips spine leftupleg leftleg leftfoot leftarm leftforearm lefthand rightupleg rightarm";

// The name in lower case, without namespace, with spaces replaced by underscores.
std::string plain_name(std::string_view name) {
  const std::size_t colon = name.rfind(':');
  if (colon != std::string_view::npos) name.remove_prefix(colon + 1);
  std::string result = ascii_lower(name);
  for (char& c : result) c = c == ' ' ? '_' : c;
  return result;
}

using Names = std::unordered_set<std::string>;

// The number of words in `joints`; empty unless all of them are in `names`.
std::optional<int> matches(const Names& names, std::string_view joints) {
  int count = 0;
  while (!joints.empty()) {
    const std::size_t space = joints.find(' ');
    if (!names.contains(std::string(joints.substr(0, space)))) return std::nullopt;
    joints = space == std::string_view::npos ? std::string_view() : joints.substr(space + 1);
    ++count;
  }
  return count;
}

// iPi Mocap Studio prints the frame time with ten decimals and starts each row with a tab.
bool written_as_ipi_does(const ExporterTraits& traits) {
  const std::size_t point = traits.frame_time.find('.');
  return traits.rows_begin_with_tab && point != std::string_view::npos &&
         traits.frame_time.size() - point - 1 == 10;
}

Exporter motion_builder_names(const Skeleton& skeleton, const ExporterTraits& traits) {
  for (const std::string& name : skeleton.names) {
    if (ascii_lower(name).starts_with("mixamorig")) {
      return {"Mixamo", "joint names begin with mixamorig", Confidence::certain};
    }
  }
  const std::string names = "the joint names are MotionBuilder's";
  if (!traits.starts_unturned) {
    return {"MotionBuilder's names", names + ", which many programs use", Confidence::likely};
  }
  if (written_as_ipi_does(traits)) {
    return {"iPi Mocap Studio, MotionBuilder's names with a rest pose as frame 0",
            names + ", frame 0 has no rotations, and rows and frame time are printed as by iPi",
            Confidence::likely};
  }
  return {"MotionBuilder's names with a rest pose as frame 0",
          names + ", and frame 0 has no rotations, as with iPi Mocap Studio's second preset",
          Confidence::guess};
}

}  // namespace

void apply_exporter(const Exporter& exporter, Conventions& conventions) {
  if (!exporter.up || !exporter.forward || exporter.confidence != Confidence::certain) return;
  const std::string reason = exporter.name + "'s files have it";
  const Confidence alone = conventions.up_confidence;
  conventions.up_confidence = Confidence::certain;
  if (conventions.up != *exporter.up) {
    if (alone == Confidence::certain) return;
    // A motion that clearly shows another axis may have been turned since.
    if (alone == Confidence::likely) conventions.up_confidence = Confidence::guess;
    conventions.up = *exporter.up;
    conventions.up_reason =
        alone == Confidence::likely ? reason + ", but " + conventions.up_reason : reason;
    conventions.forward_confidence = Confidence::guess;
  }
  if (conventions.forward_confidence != Confidence::guess) return;
  conventions.forward = *exporter.forward;
  conventions.forward_confidence = Confidence::likely;
  conventions.forward_reason = reason;
}

std::optional<Exporter> recognise_exporter(const Skeleton& skeleton, const ExporterTraits& traits) {
  Names names;
  for (const std::string& name : skeleton.names) names.insert(plain_name(name));
  for (const NameSet& set : kNameSets) {
    const auto count = matches(names, set.joints);
    if (!count) continue;
    std::string reason = fmt::format("{} joint names match", *count);
    if (set.exporter.starts_with("iPi") && written_as_ipi_does(traits)) {
      reason += ", and rows and frame time are printed as by iPi";
    }
    return Exporter{std::string(set.exporter), std::move(reason), set.confidence, set.up,
                    set.forward};
  }
  if (matches(names, kMotionBuilderNames)) return motion_builder_names(skeleton, traits);
  return std::nullopt;
}

}  // namespace krok
