#include "capture/convention_choice.h"

#include <fmt/format.h>

#include <array>
#include <unordered_set>

#include "core/numbers.h"
#include "core/text.h"

namespace krok {

namespace {

constexpr const char* kGiven = "as given";

bool parallel(Direction a, Direction b) {
  return direction_vector(a).dot(direction_vector(b)) != 0.0;
}

std::string how(bool given, Confidence confidence) {
  return given ? "given" : fmt::format("detected, {}", confidence_name(confidence));
}

}  // namespace

void apply_given(const GivenConventions& given, Conventions& conventions) {
  const std::string axes_reason = given.axes_reason.empty() ? kGiven : given.axes_reason;
  if (given.unit) {
    conventions.unit = *given.unit;
    conventions.unit_confidence = Confidence::certain;
    conventions.unit_reason = kGiven;
  }
  if (given.up) {
    if (given.axes_given(given.up) && conventions.up != *given.up &&
        conventions.up_confidence != Confidence::guess) {
      conventions.up_doubt =
          fmt::format("{} is {}: {}", direction_name(conventions.up),
                      confidence_name(conventions.up_confidence), conventions.up_reason);
    }
    conventions.up = conventions.reference_up = *given.up;
    conventions.up_confidence = given.axes_confidence;
    conventions.up_reason = axes_reason;
  }
  if (given.forward) {
    // With another up axis, what is ahead was looked for along the wrong ones.
    if (given.axes_given(given.forward) && conventions.forward != *given.forward &&
        conventions.forward_confidence != Confidence::guess && conventions.up_doubt.empty()) {
      conventions.forward_doubt =
          fmt::format("{} is {}: {}", direction_name(conventions.forward),
                      confidence_name(conventions.forward_confidence), conventions.forward_reason);
    }
    conventions.forward = conventions.reference_forward = *given.forward;
    conventions.forward_confidence = given.forward_confidence;
    conventions.forward_reason = axes_reason;
  }
  if (given.reference_up) conventions.reference_up = *given.reference_up;
  if (given.reference_forward) conventions.reference_forward = *given.reference_forward;
  if (given.up && given.forward) return;
  if (!parallel(conventions.up, conventions.forward) &&
      !parallel(conventions.reference_up, conventions.reference_forward)) {
    return;
  }
  if (given.up) {
    const bool along_z = parallel(*given.up, Direction::plus_z);
    conventions.forward = along_z ? Direction::minus_y : Direction::plus_z;
    conventions.reference_forward = conventions.forward;
    conventions.forward_confidence = Confidence::guess;
    conventions.forward_reason = "the detected axis is parallel to the given up axis";
  } else if (given.forward) {
    const bool along_y = parallel(*given.forward, Direction::plus_y);
    conventions.up = along_y ? Direction::plus_z : Direction::plus_y;
    conventions.reference_up = conventions.up;
    conventions.up_confidence = Confidence::guess;
    conventions.up_reason = "the detected axis is parallel to the given forward axis";
  }
}

Result<Conversion> Conversion::make(const Conventions& conventions) {
  auto turn = rotation_to_krok(conventions.up, conventions.forward);
  if (!turn) return std::move(turn).error();
  auto reference = rotation_to_krok(conventions.reference_up, conventions.reference_forward);
  if (!reference) return std::move(reference).error();
  Conversion conversion;
  conversion.metres_ = conventions.unit.metres;
  conversion.turn_ = *turn;
  conversion.reference_turn_ = *reference;
  conversion.to_krok_ = turn->toRotationMatrix().array().round().matrix();
  conversion.reference_to_krok_ = reference->toRotationMatrix().array().round().matrix();
  if (conversion.to_krok_ != conversion.reference_to_krok_) {
    conversion.reference_to_motion_.orientation = *turn * reference->conjugate();
  }
  return conversion;
}

Transform Conversion::pose(const Transform& joint_to_world) const {
  return {to_krok_ * (joint_to_world.position * metres_),
          turn_ * joint_to_world.orientation * reference_turn_.conjugate()};
}

Transform Conversion::reference(const Transform& joint_to_world) const {
  return {reference_to_krok_ * (joint_to_world.position * metres_),
          reference_rotation(joint_to_world.orientation)};
}

Quat Conversion::reference_rotation(const Quat& rotation) const {
  return reference_turn_ * rotation * reference_turn_.conjugate();
}

void report_conventions(const Conventions& conventions, const GivenConventions& given,
                        const std::string& code_prefix, const std::string& file_name,
                        Diagnostics& diagnostics) {
  const auto report = [&](bool is_given, const char* name, const char* subject,
                          const std::string& value, Confidence confidence,
                          const std::string& reason) {
    if (is_given) return;
    const bool guess = confidence == Confidence::guess;
    Diagnostic diagnostic;
    diagnostic.severity = guess ? Severity::warning : Severity::note;
    diagnostic.code = fmt::format("{}-{}", code_prefix, name);
    diagnostic.message = fmt::format("{} is {} ({})", subject, value, confidence_name(confidence)) +
                         (reason.empty() ? std::string() : ": " + reason);
    if (guess) diagnostic.hint = fmt::format("set it with --{} if that is wrong", name);
    if (guess && name == std::string_view("up") && code_prefix != "scene") {
      diagnostic.hint += ", or take the axes of a take that stands with --axes-from";
    }
    diagnostic.where.file = file_name;
    diagnostics.push_back(std::move(diagnostic));
  };
  report(given.unit.has_value(), "unit", "the unit", conventions.unit.name,
         conventions.unit_confidence, conventions.unit_reason);
  const auto doubt = [&](const char* name, Direction is, const std::string& why) {
    if (why.empty()) return;
    diagnostics.push_back(
        make_warning(fmt::format("{}-{}", code_prefix, name),
                     fmt::format("{} is {}, as given; {}", name, direction_name(is), why),
                     fmt::format("without --{} it is detected", name), file_name));
  };
  doubt("up", conventions.up, conventions.up_doubt);
  doubt("forward", conventions.forward, conventions.forward_doubt);
  report(given.axes_given(given.up), "up", "up", std::string(direction_name(conventions.up)),
         conventions.up_confidence, conventions.up_reason);
  report(given.axes_given(given.forward), "forward", "forward",
         std::string(direction_name(conventions.forward)), conventions.forward_confidence,
         conventions.forward_reason);
}

std::vector<std::string> describe_conversions(const Conventions& conventions,
                                              const GivenConventions& given) {
  std::vector<std::string> lines;
  if (conventions.unit.metres != 1.0) {
    lines.push_back(fmt::format("unit: {} ({} m) to metres ({})", conventions.unit.name,
                                readable(conventions.unit.metres),
                                how(given.unit.has_value(), conventions.unit_confidence)));
  }
  const auto axes = [&](const char* what, Direction up, Direction forward) {
    if (up == Direction::plus_y && forward == Direction::plus_z) return;
    lines.push_back(fmt::format(
        "{}: up {} ({}), forward {} ({}) to up y, forward z", what, direction_name(up),
        how(given.axes_given(given.up), conventions.up_confidence), direction_name(forward),
        how(given.axes_given(given.forward), conventions.forward_confidence)));
  };
  axes("axes", conventions.up, conventions.forward);
  if (conventions.reference_up != conventions.up ||
      conventions.reference_forward != conventions.forward) {
    axes("axes of the reference pose", conventions.reference_up, conventions.reference_forward);
  }
  return lines;
}

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
