#include "formats/npy/array_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "capture/far_values.h"
#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/json/fields.h"
#include "formats/npy/array_motion_internal.h"
#include "motion/hips_root.h"
#include "motion/travel.h"
#include "positions/from_positions.h"
#include "scene/clip.h"

namespace krok::npy {

namespace {

constexpr double kFarOff = 0.02;     // metres, of joints with bones of constant length
constexpr double kNotNoise = 0.002;  // metres, where the places are free of noise

constexpr double kDeep = 0.3;  // metres: deeper than a step goes

constexpr std::initializer_list<const char*> kPositionNames = {
    "posed_joints", "positions", "joints", "joints3d", "joints_3d", "joint_positions",
    "keypoints3d",  "keypoints", "motion", "xyz",      "pred_xyz",  "Jtr"};

Result<ArrayMotion> motion_of(const ArrayFile& file) {
  const Arrays& arrays = file.arrays;
  if (arrays.names().front().empty()) return motion_of_positions(file, "");
  if (arrays.has("positions") && arrays.has("quaternions") && arrays.has("parents")) {
    return read_krok(file);
  }
  if (arrays.has("poses") || arrays.has("smpl_poses") || arrays.has("full_pose") ||
      arrays.has("thetas") || arrays.has("pose_body") || arrays.has("body_pose")) {
    return read_smpl(file);
  }
  const std::string positions = file.find(kPositionNames);
  if (!positions.empty()) {
    const auto global = file.find({"global_rot_mats", "global_rotations"});
    if (!global.empty()) return motion_of_rotations(file, positions, global, true);
    const auto local = file.find({"local_rot_mats", "local_rotations"});
    if (!local.empty()) return motion_of_rotations(file, positions, local, false);
    return motion_of_positions(file, positions);
  }
  if (arrays.names().size() == 1) return motion_of_positions(file, arrays.names().front());
  std::vector<std::string> names(
      arrays.names().begin(),
      arrays.names().begin() + std::min<std::ptrdiff_t>(std::ssize(arrays.names()), 12));
  return Error("npy-arrays",
               fmt::format("none of the arrays is known as a motion: {}",
                           shown(fmt::format("{}", fmt::join(names, ", ")))),
               "name the positions \"positions\"; formats/npy/SPEC.md lists the names");
}

// Where +Z goes as +Y is turned to the axis that is up; of -Y as if about X.
Direction forward_below(Direction up) {
  switch (up) {
    case Direction::plus_z:
      return Direction::minus_y;
    case Direction::minus_z:
      return Direction::plus_y;
    case Direction::minus_y:
      return Direction::minus_z;
    case Direction::plus_x:
    case Direction::minus_x:
    case Direction::plus_y:
      break;
  }
  return Direction::plus_z;
}

// Lengths of bones for the reference pose, by a few frames, in the file's unit.
void take_lengths(ArrayMotion& motion) {
  const std::size_t joints = motion.skeleton.names.size();
  const std::size_t frames = motion.positions.size() / joints;
  const std::size_t step = std::max<std::size_t>((frames + kMaxSamples - 1) / kMaxSamples, 1);
  auto& reference = motion.skeleton.reference;
  const std::vector<Transform> usual = reference;
  for (std::size_t j = 1; j < joints; ++j) {
    const std::size_t parent = at(motion.skeleton.parents[j]);
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t f = 0; f < frames; f += step, ++count) {
      sum += (motion.positions[f * joints + j] - motion.positions[f * joints + parent]).norm();
    }
    const double length = sum / static_cast<double>(std::max<std::size_t>(count, 1));
    const Vec3 direction = (usual[j].position - usual[parent].position).stableNormalized();
    reference[j].position = reference[parent].position + length * direction;
  }
}

class Reader {
 public:
  // With `packed`, the frames of arrays as krok-export writes them stay packed.
  explicit Reader(const ArrayFile& file, PackedFrames* packed = nullptr)
      : file_(file), options_(file.options), packed_(packed) {}

  Result<Capture> read() {
    if (Status status = check_rate(options_.rate, "npy-rate"); !status) return status.error();
    auto motion = packed_ != nullptr ? read_krok(file_, packed_) : motion_of(file_);
    if (!motion) return motion.error();
    motion_ = *std::move(motion);
    capture_.diagnostics = std::move(motion_.diagnostics);
    capture_.motions = motion_.motions;
    capture_.has_rotations = !motion_.orientations.empty();
    if (at(options_.max_joints) < motion_.skeleton.names.size()) {
      return Error("npy-limit", "the array has too many joints");
    }
    if (Status status = choose_rate(); !status) return status.error();
    if (Status status = find_contacts(); !status) return status.error();
    if (!capture_.has_rotations) take_lengths(motion_);
    if (options_.roles) {
      auto roles = options_.roles(motion_.skeleton);
      if (!roles) return roles.error();
      motion_.roles = *std::move(roles);
    }
    if (Status status = convert(); !status) return status.error();
    capture_.roles = motion_.roles;
    capture_.keys = std::move(motion_.keys);
    if (capture_.has_rotations) {
      fill_clip();
    } else {
      find_rotations();
    }
    check_ground();
    check_sides();
    for (Diagnostic& diagnostic : capture_.diagnostics) {
      if (diagnostic.where.file.empty()) diagnostic.where.file = file_.name;
    }
    return std::move(capture_);
  }

  // The frames of the clip from those that are packed, as convert() and fill_clip() make them.
  FrameSource unpacked(const Clip& clip) const {
    FrameSource source;
    source.skeleton = clip.skeleton;
    source.rate = clip.rate;
    source.frame_count = static_cast<int>(packed_->count);
    source.read = [read = packed_->read](int first, int, auto... block) {
      return read(at(first), block...);
    };
    constexpr int kFrames = 4096;
    return changed_in_blocks(
        source, {kFrames, 0}, 1, [conversion = conversion_, axes = axes_](FrameRun& run) -> Status {
          for (Vec3f& place : run.clip.positions) {
            const Vec3 converted = axes * place.cast<double>();
            if (!is_near(converted)) return Error("npy-value", "a joint is over 1e9 m away");
            place = converted.cast<float>();
          }
          for (Quatf& turn : run.clip.orientations) {
            const auto read = unit_quaternion(turn.coeffs().cast<double>());
            if (!read) return Error("npy-rotation", "a quaternion is not of length 1");
            turn = conversion.pose({Vec3::Zero(), *read}).orientation.normalized().cast<float>();
          }
          return {};
        });
  }

 private:
  void report(Severity severity, std::string code, std::string message, std::string hint = {}) {
    capture_.diagnostics.push_back(
        make_diagnostic(severity, std::move(code), std::move(message), std::move(hint)));
  }

  Status find_contacts() {
    const std::size_t joints = motion_.skeleton.names.size();
    if (packed_ == nullptr) {
      return add_contacts(
          file_, capture_.clip.rate, motion_.positions.size() / joints,
          [&](std::size_t frame, std::size_t, int joint) {
            return motion_.positions[frame * joints + at(joint)];
          },
          motion_);
    }
    const std::vector<Vec3f> places = std::exchange(packed_->contact_places, {});
    const std::size_t columns = places.size() / std::max<std::size_t>(packed_->count, 1);
    return add_contacts(
        file_, capture_.clip.rate, packed_->count,
        [&](std::size_t frame, std::size_t column, int) {
          return Vec3(places[frame * columns + column].cast<double>());
        },
        motion_);
  }

  Status choose_rate() {
    const auto stated = file_.number(
        {"rate", "fps", "framerate", "frame_rate", "mocap_framerate", "mocap_frame_rate"});
    if (!stated) return stated.error();
    double& rate = capture_.clip.rate;
    if (options_.rate) {
      rate = *options_.rate;
      capture_.rate = {readable(rate), "as given", Confidence::certain};
    } else if (*stated) {
      rate = **stated;
      if (Status status = check_frame_rate(rate, "npy-rate"); !status) return status;
      capture_.rate = {readable(rate), "stated in the file", Confidence::certain};
    } else {
      const bool usual = motion_.usual_rate > 0;
      rate = usual ? motion_.usual_rate : 30;
      capture_.rate = {readable(rate),
                       usual ? "the file does not state it; data of this kind usually has it"
                             : "the file does not state it",
                       Confidence::guess};
      report(Severity::warning, "npy-rate",
             fmt::format("{} frames per second: {}", readable(rate), capture_.rate.reason),
             "set the rate with --fps N if this is wrong");
    }
    return {};
  }

  // Metres, +Y up, facing +Z: what the motion shows besides is a doubt.
  void keep_own(Conventions& conventions) {
    const Conventions seen = std::exchange(conventions, {});
    conventions.unit_confidence = conventions.up_confidence = conventions.forward_confidence =
        Confidence::certain;
    conventions.unit_reason = conventions.up_reason = conventions.forward_reason =
        "as krok-export writes arrays of these names";
    // They are no evidence against what is given.
    if (options_.up) conventions.up_confidence = Confidence::guess;
    if (options_.forward) conventions.forward_confidence = Confidence::guess;
    const auto doubt = [&](const char* option, const std::string& is, const std::string& shown,
                           const std::string& why) {
      report(Severity::warning, fmt::format("npy-{}", option),
             fmt::format("{} is {}, as krok-export writes arrays of these names; the motion shows "
                         "{}: {}",
                         option, is, shown, why),
             fmt::format("--{} {} if it is", option, shown));
    };
    if (!options_.unit && seen.unit_confidence == Confidence::certain && seen.unit.metres != 1) {
      doubt("unit", "m", seen.unit.name, seen.unit_reason);
    }
    if (!options_.up && seen.up_confidence == Confidence::certain && seen.up != conventions.up) {
      doubt("up", "y", std::string(direction_name(seen.up)), seen.up_reason);
    }
  }

  Status convert() {
    Conventions& conventions = capture_.conventions;
    const std::size_t joints = motion_.skeleton.names.size();
    const std::size_t frames = motion_.positions.size() / joints;
    std::vector<Vec3> samples;
    const std::size_t count = std::min(frames, kMaxSamples);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t f = sampled_frame(i, frames);
      samples.insert(samples.end(), &motion_.positions[f * joints],
                     &motion_.positions[f * joints] + joints);
    }
    conventions = detect_conventions(motion_.skeleton, motion_.roles, samples);
    if (motion_.is_krok) keep_own(conventions);
    if (motion_.upright) {
      conventions.forward = forward_below(conventions.up);
      conventions.forward_confidence = Confidence::certain;
      conventions.forward_reason = "the reference pose is made so";
    }
    apply_given(options_, conventions);
    if (motion_.upright) {
      conventions.reference_up = Direction::plus_y;
      conventions.reference_forward = Direction::plus_z;
    }
    report_conventions(conventions, options_, "npy", file_.name, capture_.diagnostics);
    const auto conversion = Conversion::make(conventions);
    if (!conversion) return conversion.error();
    conversion_ = *conversion;
    capture_.clip.provenance.conversions = describe_conversions(conventions, options_);
    for (Transform& joint : motion_.skeleton.reference) joint = conversion->reference(joint);
    Mat3& axes = axes_;
    for (int i = 0; i < 3; ++i) {
      axes.col(i) = conversion->pose({Vec3::Unit(i), Quat::Identity()}).position;
    }
    for (std::size_t i = 0; i < motion_.positions.size(); ++i) {
      motion_.positions[i] = axes * motion_.positions[i];
      if (!is_near(motion_.positions[i])) {
        Error error("npy-value", "a joint is over 1e9 m away", "set the unit with --unit");
        error.joint = motion_.skeleton.names[i % joints];
        error.frame = static_cast<std::int64_t>(i / joints);
        return error;
      }
    }
    for (Quat& turn : motion_.orientations) {
      turn = conversion->pose({Vec3::Zero(), turn}).orientation;
    }
    for (Contact& contact : motion_.keys.contacts) {
      contact.place = axes * contact.place;
    }
    return {};
  }

  void fill_clip() {
    Clip& clip = capture_.clip;
    clip.skeleton = motion_.skeleton;
    clip.positions.reserve(motion_.positions.size());
    for (const Vec3& place : motion_.positions) clip.positions.push_back(place.cast<float>());
    for (const Quat& turn : motion_.orientations) {
      clip.orientations.push_back(turn.normalized().cast<float>());
    }
  }

  void find_rotations() {
    for (const std::size_t gap : motion_.gaps) motion_.positions[gap].setConstant(std::nan(""));
    const std::vector<int> glitches =
        remove_glitches(motion_.skeleton.parents, capture_.clip.rate, motion_.positions);
    PositionsToPose input;
    input.skeleton = motion_.skeleton;
    input.roles = motion_.roles;
    input.positions = motion_.positions;
    input.rate = capture_.clip.rate;
    input.jobs = options_.jobs;
    PoseFromPositions found = from_positions(input);
    found.clip.provenance = std::move(capture_.clip.provenance);
    capture_.clip = std::move(found.clip);
    capture_.clip.provenance.conversions.emplace_back("rotations found from joint positions");
    capture_.noise = found.noise;
    capture_.rms = found.rms;
    capture_.largest = found.largest;
    const auto millimetres = [](double metres) { return readable(1e3 * metres, 3); };
    report(Severity::note, "npy-noise",
           fmt::format("rotations found from positions: joints are {} mm from the file's (RMS), at "
                       "most {} mm; noise {} mm{}",
                       millimetres(found.rms), millimetres(found.largest), millimetres(found.noise),
                       found.smoothed ? ", smoothed" : ""));
    const std::vector<std::string>& names = capture_.clip.skeleton.names;
    if (found.root_at_body) {
      report(Severity::warning, "npy-root",
             fmt::format("'{}' is not a joint of the body, which moves away from it: it is put "
                         "where '{}' is",
                         shown(names[0]), shown(names[1])));
    }
    for (std::size_t j = 0; j < names.size(); ++j) {
      if (glitches[j] == 0) continue;
      report(Severity::warning, "npy-glitch",
             fmt::format("joint '{}' is off its bones in {}: filled from the frames before "
                         "and after",
                         shown(names[j]), counted(glitches[j], "frame")));
      capture_.diagnostics.back().joint = names[j];
    }
    const bool clean = found.rms > kNotNoise && found.rms > 100 * found.noise;
    if (clean || found.rms > std::max(kFarOff, 3 * found.noise)) {
      report(Severity::warning, "npy-fit",
             fmt::format("joints are {} mm from the file's (RMS), '{}' at most: {} mm in frame {}",
                         millimetres(found.rms), shown(names[at(found.largest_joint)]),
                         millimetres(found.largest), found.largest_frame),
             "is --skeleton the right one, each joint below the one it hangs on?");
    }
    if (found.length_variation > 0.1) {
      report(Severity::warning, "npy-bones",
             fmt::format("the bones change their lengths by {}%: their mean is used",
                         readable(100 * found.length_variation, 3)),
             "is --skeleton the right one?");
    }
  }

  // Positions relative to the hips, as MediaPipe's landmarks in the world are.
  void check_ground() {
    const Clip& clip = capture_.clip;
    const double depth = onto_ground(clip, foot_joints(clip.skeleton, capture_.roles)).position.y();
    if (motion_.is_krok || depth < kDeep) return;
    report(Severity::warning, "npy-ground",
           fmt::format("the lowest foot is {} m below the ground", readable(depth, 3)),
           "krok-edit --on-ground moves it to y = 0");
  }

  // The knees of people bend ahead: those of a mirrored body, whose left is its right, do not.
  void check_sides() {
    constexpr double kBent = 0.05, kMost = 0.8;  // of the leg; of the frames
    constexpr int kMinBent = 10;
    const Clip& clip = capture_.clip;
    const RoleMap& roles = capture_.roles;
    const int left = roles.joint(Role::left_upper_leg), right = roles.joint(Role::right_upper_leg);
    if (motion_.is_krok || left < 0 || right < 0) return;
    const int step = std::max(1, clip.frame_count() / static_cast<int>(kMaxSamples));
    int bent = 0, backwards = 0;
    for (int f = 0; f < clip.frame_count(); f += step) {
      const auto pose = clip.frame_positions(f);
      const Vec3f ahead = (pose[at(left)] - pose[at(right)]).cross(Vec3f::UnitY());
      for (const auto& [hip, knee, foot] :
           {std::tuple(left, roles.joint(Role::left_lower_leg), roles.joint(Role::left_foot)),
            std::tuple(right, roles.joint(Role::right_lower_leg), roles.joint(Role::right_foot))}) {
        if (knee < 0 || foot < 0) return;
        const Vec3f leg = pose[at(foot)] - pose[at(hip)], thigh = pose[at(knee)] - pose[at(hip)];
        const Vec3f off = thigh - leg * (thigh.dot(leg) / std::max(leg.squaredNorm(), 1e-12F));
        if (off.norm() < kBent * leg.norm()) continue;
        ++bent;
        backwards += off.dot(ahead) < 0 ? 1 : 0;
      }
    }
    if (bent < kMinBent || backwards < kMost * bent) return;
    report(Severity::warning, "npy-sides",
           fmt::format("knees bend backwards {} times of {}: left and right are exchanged, or an "
                       "axis is mirrored",
                       backwards, bent),
           "array * [-1, 1, 1] mirrors x; array[..., [0, 2, 1]] exchanges y and z");
  }

  const ArrayFile& file_;
  const ReadOptions& options_;
  PackedFrames* packed_;
  ArrayMotion motion_;
  Conversion conversion_;
  Mat3 axes_ = Mat3::Identity();
  Capture capture_;
};

}  // namespace

std::string ArrayFile::find(std::initializer_list<const char*> names) const {
  for (const char* wanted : names) {
    if (arrays.has(wanted)) return wanted;
  }
  return {};
}

Result<std::vector<double>> ArrayFile::numbers(const std::string& array,
                                               std::vector<std::size_t>& shape) const {
  const auto read = arrays.read(array);
  if (!read) return read.error();
  bool right = read->is_number() && (shape.empty() || shape.size() == read->shape.size());
  for (std::size_t d = 0; right && d < shape.size(); ++d) {
    right = shape[d] == 0 || shape[d] == read->shape[d];
  }
  if (!right) {
    return Error("npy-shape", fmt::format("{} has the shape {}, expected {}", array,
                                          shape_text(read->shape), shape_text(shape)));
  }
  shape = read->shape;
  std::vector<double> values = read->numbers();
  const auto wrong = std::ranges::find_if(values, [](double v) { return !std::isfinite(v); });
  if (wrong == values.end()) return values;
  Error error("npy-value", fmt::format("{} has the value {}", array, *wrong));
  if (!shape.empty() && shape[0] > 0) {
    const std::size_t row = values.size() / shape[0];
    error.frame = (wrong - values.begin()) / static_cast<std::ptrdiff_t>(row);
  }
  return error;
}

Result<std::optional<double>> ArrayFile::number(std::initializer_list<const char*> names) const {
  const std::string found = find(names);
  if (found.empty()) return std::optional<double>();
  std::vector<std::size_t> shape;
  const auto values = numbers(found, shape);
  if (!values) return values.error();
  if (values->size() != 1) {
    return Error("npy-shape",
                 fmt::format("{} has the shape {}, expected one number", found, shape_text(shape)));
  }
  return std::optional((*values)[0]);
}

void pose_frames(const std::vector<Quat>& rotations, const std::vector<Vec3>& roots,
                 ArrayMotion& motion) {
  const std::size_t joints = motion.skeleton.names.size();
  motion.positions.resize(rotations.size());
  motion.orientations.resize(rotations.size());
  std::vector<Transform> locals(joints), pose(joints);
  for (std::size_t j = 0; j < joints; ++j) {
    locals[j] = motion.skeleton.reference_local(static_cast<int>(j));
  }
  for (std::size_t f = 0; f < roots.size(); ++f) {
    locals[0].position = roots[f];
    for (std::size_t j = 0; j < joints; ++j) locals[j].orientation = rotations[f * joints + j];
    local_to_world(motion.skeleton.parents, locals, pose);
    for (std::size_t j = 0; j < joints; ++j) {
      motion.positions[f * joints + j] = pose[j].position;
      motion.orientations[f * joints + j] = pose[j].orientation;
    }
  }
}

Result<Capture> read(std::span<const std::byte> file, const std::string& file_name,
                     const ReadOptions& options) {
  auto arrays = Arrays::open(file);
  if (!arrays) return std::move(arrays.error()).in_file(file_name);
  const ArrayFile given{*arrays, file_name, options};
  auto capture = Reader(given).read();
  if (!capture) return std::move(capture.error()).in_file(file_name);
  return capture;
}

std::optional<OpenedCapture> open(std::span<const std::byte> file, const std::string& file_name,
                                  const ReadOptions& options, std::size_t min_transforms) {
  auto arrays = Arrays::open(file);
  if (!arrays) return std::nullopt;
  for (const char* name : {"positions", "quaternions", "parents"}) {
    if (!arrays->has(name)) return std::nullopt;
  }
  const auto kept = std::make_shared<const Arrays>(*std::move(arrays));
  const auto positions = kept->open_array("positions");
  if (!positions || positions->count() < 3 * min_transforms) return std::nullopt;
  const ArrayFile given{*kept, file_name, options};
  PackedFrames packed;
  Reader reader(given, &packed);
  auto capture = reader.read();
  if (!capture) return std::nullopt;
  OpenedCapture opened{*std::move(capture), {}};
  opened.frames = reader.unpacked(opened.clip);
  opened.frames.read = [kept, read = std::move(opened.frames.read)](auto... block) {
    return read(block...);
  };
  opened.clip.resize(0);
  return opened;
}

Result<PositionSkeleton> read_columns(std::string_view text) {
  json::Object<PositionJoint> joint;
  joint.field("name", &PositionJoint::name, json::name()).required();
  joint.field("parent", &PositionJoint::parent,
              json::kind<std::string>("", [](const json::Given& given, std::string& parent) {
                if (given.value.kind == json::Value::Kind::null) return Status();
                return json::text().read(given, &parent);
              }));
  joint.field("role", &PositionJoint::role, json::text())
      .check([](const json::Given& given, PositionJoint& of) -> Status {
        if (of.role.empty() || parse_role_label(of.role)) return {};
        return given.member("role").wrong("\"" + shown(of.role) + "\" is no role");
      });
  joint.field("mean_of", &PositionJoint::mean_of, json::list(json::text(), {"a column", 1, 1000}));
  json::Object<PositionSkeleton> file("the skeleton");
  std::string schema;  // may be missing
  file.context("schema", schema, json::text()).comment();
  file.field("rate", &PositionSkeleton::rate, json::frame_rate());
  file.field("joints", &PositionSkeleton::joints,
             json::list<PositionJoint>(json::object(joint), {"joint {0}", 1, 10'000}))
      .required();
  auto skeleton = file.read_text(text, "columns");
  if (!skeleton) return skeleton;
  if (auto arranged = arrange(*skeleton); !arranged) return arranged.error();
  return skeleton;
}

}  // namespace krok::npy
