#include "formats/npy/npz_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <set>
#include <tuple>

#include "core/index.h"
#include "core/numbers.h"
#include "formats/npy/array_motion_internal.h"
#include "math/quaternion.h"

namespace krok::npy {

namespace {

Vec3 vector_at(const std::vector<double>& values, std::size_t i) {
  return Vec3(&values[3 * i]);
}

Result<std::vector<Quat>> quaternions_of(const std::vector<double>& values) {
  std::vector<Quat> quaternions(values.size() / 4);
  for (std::size_t i = 0; i < quaternions.size(); ++i) {
    const auto unit = unit_quaternion(Vec4(&values[4 * i]));
    if (!unit) return Error("npy-rotation", fmt::format("quaternion {} is not of length 1", i));
    quaternions[i] = *unit;
  }
  return quaternions;
}

// How much joints move in the frames of their parents as the quaternions have these, over the
// bones' lengths: 0 for rigid bones. The median over joints.
double looseness(const Skeleton& skeleton, const std::vector<double>& places,
                 const std::vector<Quat>& turns) {
  const std::size_t joints = skeleton.parents.size(), frames = turns.size() / joints;
  const std::size_t step = std::max<std::size_t>(frames / 50, 1);
  std::vector<double> all;
  for (std::size_t j = 1; j < joints; ++j) {
    const std::size_t parent = at(skeleton.parents[j]);
    Vec3 first = Vec3::Zero();
    double most = 0;
    for (std::size_t f = 0; f < frames; f += step) {
      const Vec3 bone = vector_at(places, f * joints + j) - vector_at(places, f * joints + parent);
      const Vec3 offset = turns[f * joints + parent].conjugate() * bone;
      if (f == 0) first = offset;
      most = std::max(most, (offset - first).norm());
    }
    if (first.norm() > 1e-6) all.push_back(most / first.norm());
  }
  if (all.empty()) return 0;
  std::ranges::nth_element(all, all.begin() + std::ssize(all) / 2);
  return all[all.size() / 2];
}

// Quaternions of another order make bones that swing about.
Status check_order(const Skeleton& skeleton, const std::vector<double>& places,
                   const std::vector<Quat>& turns, Diagnostics& diagnostics) {
  constexpr double kRigid = 0.05, kLoose = 0.2;
  const double given = looseness(skeleton, places, turns);
  if (given < kLoose) return {};
  std::vector<Quat> w_first;
  for (const Quat& q : turns) w_first.emplace_back(q.x(), q.y(), q.z(), q.w());
  if (looseness(skeleton, places, w_first) < kRigid) {
    return Error("npy-rotation", "the quaternions are w, x, y, z; x, y, z, w are needed",
                 "numpy.roll(quaternions, -1, axis=-1) brings them into order");
  }
  diagnostics.push_back(make_warning(
      "npy-rotation",
      fmt::format("the positions do not follow the quaternions: half of the bones move by {}% of "
                  "their length or more in the frames of their parents",
                  readable(100 * given, 3)),
      "they are x, y, z, w, joint to world"));
  return {};
}

// Each run of frames in which a joint is down, at its mean place.
void add_runs(const std::vector<double>& down, std::size_t column, std::size_t columns, int joint,
              double rate, const PlaceOf& place, ArrayMotion& motion) {
  const std::size_t frames = down.size() / columns;
  for (std::size_t f = 0; f < frames; ++f) {
    if (down[f * columns + column] < 0.5) continue;
    Contact contact;
    contact.joint = joint;
    contact.start = static_cast<double>(f) / rate;
    const std::size_t first = f;
    for (; f < frames && down[f * columns + column] >= 0.5; ++f) {
      contact.place += place(f, column, joint);
    }
    contact.end = static_cast<double>(f - 1) / rate;
    contact.place /= static_cast<double>(f - first);
    motion.keys.contacts.push_back(contact);
  }
}

Result<std::vector<int>> contact_joints(const ArrayFile& file, std::size_t joint_count) {
  const auto given = file.numbers("contact_joints", {0});
  if (!given) return given.error();
  std::vector<int> joints;
  for (const double joint : *given) {
    if (!(joint >= 0 && joint < static_cast<double>(joint_count))) {
      return Error("npy-value", fmt::format("contact_joints has {}, of no joint", joint));
    }
    joints.push_back(static_cast<int>(joint));
  }
  return joints;
}

}  // namespace

std::optional<Quat> unit_quaternion(const Vec4& values) {
  Quat quaternion(values);
  const double norm = quaternion.norm();
  if (!(std::abs(norm - 1) < 1e-3)) return std::nullopt;
  quaternion.coeffs() /= norm;
  return quaternion;
}

Status add_contacts(const ArrayFile& file, double rate, std::size_t frames, const PlaceOf& place,
                    ArrayMotion& motion) {
  const std::string name = file.find({"contacts", "foot_contacts"});
  if (name.empty()) return {};
  std::vector<int> joints;
  if (file.arrays.has("contact_joints")) {
    auto given = contact_joints(file, motion.skeleton.names.size());
    if (!given) return given.error();
    joints = *std::move(given);
  } else {
    // Kimodo's: left heel, left toe, right heel, right toe (docs/source/user_guide).
    for (const Role role : {Role::left_foot, Role::left_toes, Role::right_foot, Role::right_toes}) {
      joints.push_back(motion.roles.joint(role));
    }
  }
  if (joints.empty()) return {};
  const auto down = file.numbers(name, {frames, joints.size()});
  if (!down) return down.error();
  for (std::size_t c = 0; c < joints.size(); ++c) {
    if (joints[c] >= 0) add_runs(*down, c, joints.size(), joints[c], rate, place, motion);
  }
  std::ranges::stable_sort(motion.keys.contacts, [](const Contact& a, const Contact& b) {
    return std::pair(a.start, a.joint) < std::pair(b.start, b.joint);
  });
  return {};
}

namespace {

// Unpacks positions and quaternions of frames side by side, from the beginning again where frames
// are read that were read before.
class Unpacker {
 public:
  explicit Unpacker(const Arrays& arrays) : arrays_(arrays) {}

  // Opens the arrays, and sets how many frames and joints they have.
  Status open(PackedFrames& frames) {
    for (auto& [array, name, size] :
         {std::tuple(&positions_, "positions", 3), std::tuple(&turns_, "quaternions", 4)}) {
      auto opened = arrays_.open_array(name);
      if (!opened) return opened.error();
      *array = *std::move(opened);
      const auto& shape = array->shape;
      if (array->element != Element::real || array->item_size != 4 || array->big_endian ||
          array->column_major || shape.size() != 3 || shape[2] != static_cast<std::size_t>(size)) {
        return Error("npy-shape", "the array is not as krok-export writes it");
      }
    }
    frames.count = positions_.shape[0], frames.joints = joints_ = positions_.shape[1];
    next_ = 0;
    if (turns_.shape[0] == frames.count && turns_.shape[1] == joints_ && joints_ > 0 &&
        frames.count < std::size_t{1} << 30) {
      return {};
    }
    return Error("npy-shape", "positions and quaternions differ in their shape");
  }

  Status read(std::size_t first, std::span<Vec3f> positions, std::span<Quatf> orientations) {
    if (first < next_) {
      PackedFrames again;
      if (Status status = open(again); !status) return status;
    }
    std::vector<Vec3f> skipped(joints_);
    std::vector<Quatf> skipped_turns(joints_);
    for (; next_ < first; ++next_) {
      if (Status status = take(skipped, skipped_turns); !status) return status;
    }
    next_ += positions.size() / joints_;
    return take(positions, orientations);
  }

  // Whether the arrays end after the last frame, with their checksums.
  Status at_end() {
    Status status = positions_.read({});
    return status ? turns_.read({}) : status;
  }

 private:
  Status take(std::span<Vec3f> positions, std::span<Quatf> orientations) {
    static_assert(sizeof(Vec3f) == 3 * sizeof(float) && sizeof(Quatf) == 4 * sizeof(float));
    Status status = positions_.read(std::as_writable_bytes(positions));
    return status ? turns_.read(std::as_writable_bytes(orientations)) : status;
  }

  const Arrays& arrays_;
  Array positions_, turns_;
  std::size_t joints_ = 0, next_ = 0;
};

// Reads all frames once, for a few samples and the places of contacts.
Status look_through(const ArrayFile& file, PackedFrames& frames, std::vector<double>& places,
                    std::vector<double>& turns) {
  const auto unpacker = std::make_shared<Unpacker>(file.arrays);
  if (Status status = unpacker->open(frames); !status) return status;
  if (frames.joints > at(file.options.max_joints)) return Error("npy-limit", "too many joints");
  std::vector<int> touching;
  if (file.arrays.has("contact_joints")) {
    auto given = contact_joints(file, frames.joints);
    if (!given) return given.error();
    touching = *std::move(given);
    constexpr std::size_t kMaxTouching = 64;
    if (touching.size() > kMaxTouching) return Error("npy-limit", "too many joints touch");
  } else if (!file.find({"contacts", "foot_contacts"}).empty()) {
    return Error("npy-shape", "the contacts are not as krok-export writes them");
  }
  std::vector<Vec3f> pose(frames.joints);
  std::vector<Quatf> pose_turns(frames.joints);
  for (std::size_t f = 0; f < frames.count; ++f) {
    if (Status status = unpacker->read(f, pose, pose_turns); !status) return status;
    for (const int joint : touching) frames.contact_places.push_back(pose[at(joint)]);
    if (f != sampled_frame(places.size() / (3 * frames.joints), frames.count)) continue;
    for (const Vec3f& place : pose) places.insert(places.end(), place.data(), place.data() + 3);
    for (const Quatf& turn : pose_turns) {
      turns.insert(turns.end(), turn.coeffs().data(), turn.coeffs().data() + 4);
    }
  }
  frames.read = [unpacker](auto... block) { return unpacker->read(block...); };
  return unpacker->at_end();
}

}  // namespace

std::size_t sampled_frame(std::size_t sample, std::size_t frames) {
  const std::size_t count = std::min(frames, kMaxSamples);
  return count < 2 ? 0 : sample * (frames - 1) / (count - 1);
}

Result<ArrayMotion> read_krok(const ArrayFile& file, PackedFrames* packed) {
  if (!file.options.columns_name.empty()) {
    return Error("npy-skeleton", "the file has a skeleton of its own: names and parents",
                 "leave out --skeleton");
  }
  ArrayMotion motion;
  motion.is_krok = true;
  Skeleton& skeleton = motion.skeleton;
  const auto parents = file.numbers("parents", {0});
  if (!parents) return parents.error();
  const std::size_t joints = parents->size();
  std::vector<std::size_t> places_shape = {0, joints, 3};
  Result<std::vector<double>> places = std::vector<double>(), turns = std::vector<double>();
  if (packed != nullptr) {
    Status status = look_through(file, *packed, *places, *turns);
    if (status && packed->joints != joints) status = Error("npy-shape", "other joints");
    if (!status) return status.error();
    places_shape[0] = turns->size() / (4 * joints);
  } else {
    places = file.numbers("positions", places_shape);
    if (places) turns = file.numbers("quaternions", {places_shape[0], joints, 4});
  }
  if (!places) return places.error();
  if (!turns) return turns.error();
  const std::size_t frames = places_shape[0];
  std::vector<std::string> names;
  if (file.arrays.has("names")) {
    const auto read = file.arrays.read("names");
    if (!read) return read.error();
    names = read->texts();
  }
  const auto ends = file.arrays.has("end_sites") ? file.numbers("end_sites", {joints})
                                                 : std::vector<double>(joints, 0);
  if (!ends) return ends.error();
  // Without a reference pose, the first frame.
  const bool has_rest = file.arrays.has("reference_positions");
  const auto rest_places = has_rest ? file.numbers("reference_positions", {joints, 3}) : places;
  if (!rest_places) return rest_places.error();
  const auto rest_values = has_rest ? file.numbers("reference_quaternions", {joints, 4}) : turns;
  if (!rest_values) return rest_values.error();
  const auto rest_turns = quaternions_of(*rest_values);
  if (!rest_turns) return rest_turns.error();
  if (names.empty()) {
    for (std::size_t j = 0; j < joints; ++j) names.push_back(fmt::format("joint_{}", j));
  }
  if (joints == 0 || frames == 0 || names.size() != joints) {
    return Error("npy-shape", fmt::format("there are {} frames, {} parents and {} names", frames,
                                          joints, names.size()));
  }
  for (std::size_t j = 0; j < joints; ++j) {
    const double parent = (*parents)[j];
    if (!(parent >= -1 && parent < static_cast<double>(j)) || (parent < 0) != (j == 0)) {
      return Error("npy-shape",
                   fmt::format("parents has {} for joint {}: parents come before their "
                               "children, and the first joint has none, -1",
                               parent, j));
    }
    skeleton.add(names[j], static_cast<int>(parent), {vector_at(*rest_places, j), (*rest_turns)[j]},
                 (*ends)[j] > 0.5);
  }
  if (Status status = check(skeleton); !status) return status.error();
  auto orientations = quaternions_of(*turns);
  if (!orientations) return orientations.error();
  if (Status status = check_order(skeleton, *places, *orientations, motion.diagnostics); !status) {
    return status.error();
  }
  if (packed != nullptr && !motion.diagnostics.empty()) {
    return Error("npy-rotation", "the bones are to be looked at in all frames");
  }
  motion.orientations = *std::move(orientations);
  motion.positions.resize(frames * joints);
  for (std::size_t i = 0; i < frames * joints; ++i) motion.positions[i] = vector_at(*places, i);
  motion.roles = find_roles(skeleton);
  return motion;
}

namespace {

// Gives the positions of a motion frame by frame, or its quaternions, turned to one hemisphere.
std::function<Status(std::span<std::byte>)> values_of(const FrameSource& source, int jobs,
                                                      bool turns) {
  constexpr int kFrames = 4096;
  return [=, &source, block = Clip(), before = std::vector<Quatf>(), next = 0,
          used = std::size_t{0}](std::span<std::byte> bytes) mutable -> Status {
    while (!bytes.empty()) {
      const auto values = turns ? std::as_bytes(std::span(block.orientations))
                                : std::as_bytes(std::span(block.positions));
      if (used == values.size()) {
        const int count = std::min(kFrames, source.frame_count - next);
        auto read = load(part_of(source, next, count), jobs);
        if (!read) return read.error();
        block = *std::move(read);
        next += count, used = 0;
        if (source.release) source.release(next);
        before.resize(source.skeleton.names.size(), Quatf(1, 0, 0, 0));
        for (int f = 0; f < count && turns; ++f) {
          const auto pose = block.frame_orientations(f);
          for (std::size_t j = 0; j < pose.size(); ++j) {
            if (pose[j].dot(before[j]) < 0) pose[j].coeffs() *= -1;
            before[j] = pose[j];
          }
        }
        continue;
      }
      const std::size_t count = std::min(bytes.size(), values.size() - used);
      std::ranges::copy(values.subspan(used, count), bytes.begin());
      used += count, bytes = bytes.subspan(count);
    }
    return {};
  };
}

std::vector<std::pair<std::string, Array>> arrays_of(const FrameSource& clip,
                                                     std::span<const Contact> contacts, int jobs) {
  const std::size_t joints = clip.skeleton.names.size();
  const auto frames = at(clip.frame_count);
  static_assert(sizeof(Vec3f) == 3 * sizeof(float) && sizeof(Quatf) == 4 * sizeof(float));
  Array places = array_of(std::span<const float>(), {frames, joints, 3});
  Array turns = array_of(std::span<const float>(), {frames, joints, 4});
  places.read = values_of(clip, jobs, false), turns.read = values_of(clip, jobs, true);
  std::vector<double> rest_places, rest_turns;
  for (const Transform& joint : clip.skeleton.reference) {
    rest_places.insert(rest_places.end(), joint.position.data(), joint.position.data() + 3);
    const Vec4 turn = joint.orientation.coeffs();
    rest_turns.insert(rest_turns.end(), turn.data(), turn.data() + 4);
  }
  std::set<int> touching;
  for (const Contact& contact : contacts) touching.insert(contact.joint);
  const std::vector<std::int32_t> touching_joints(touching.begin(), touching.end());
  std::vector<std::uint8_t> down(frames * touching_joints.size(), 0);
  for (const Contact& contact : contacts) {
    const auto column =
        static_cast<std::size_t>(std::distance(touching.begin(), touching.find(contact.joint)));
    const auto first = static_cast<std::size_t>(std::max(0.0, contact.start * clip.rate));
    const auto last = static_cast<std::size_t>(std::max(0.0, contact.end * clip.rate + 2));
    for (std::size_t f = first; f < std::min(frames, last); ++f) {
      const double time = static_cast<double>(f) / clip.rate;
      // Times in sidecars are whole microseconds.
      if (time < contact.start - 1e-6 || time > contact.end + 1e-6) continue;
      down[f * touching_joints.size() + column] = 1;
    }
  }
  const std::vector<std::int32_t> parents(clip.skeleton.parents.begin(),
                                          clip.skeleton.parents.end());
  return {{"positions", std::move(places)},
          {"quaternions", std::move(turns)},
          {"names", array_of_texts(clip.skeleton.names)},
          {"parents", array_of(parents, {joints})},
          {"end_sites", array_of_flags(clip.skeleton.end_sites, {joints})},
          {"reference_positions", array_of(rest_places, {joints, 3})},
          {"reference_quaternions", array_of(rest_turns, {joints, 4})},
          {"rate", array_of(std::span(&clip.rate, 1), {})},
          {"contacts", array_of_flags(down, {frames, touching_joints.size()})},
          {"contact_joints", array_of(touching_joints, {touching_joints.size()})}};
}

}  // namespace

Result<std::vector<std::byte>> write_motion(const FrameSource& source,
                                            std::span<const Contact> contacts) {
  return write(arrays_of(source, contacts, 1));
}

Status write_motion(const FrameSource& source, std::span<const Contact> contacts, int jobs,
                    OutputFile& file) {
  return write(arrays_of(source, contacts, jobs), file);
}

}  // namespace krok::npy
