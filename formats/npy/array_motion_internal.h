#pragma once

#include <functional>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "formats/npy/array_reader.h"
#include "formats/npy/npy.h"

// A motion as it stands in arrays, between the readers of its kinds and what they share.

namespace krok::npy {

struct ArrayMotion {
  Skeleton skeleton;  // the reference pose in its own axes, in the file's unit
  RoleMap roles;
  // [joints] of the array: a joint's place is their mean. Of positions alone.
  std::vector<std::vector<int>> columns;
  std::vector<Vec3> positions;     // [frames x joints], in the file's unit and axes
  std::vector<std::size_t> gaps;   // of positions alone: places that the file lacks, filled
  std::vector<Quat> orientations;  // [frames x joints], joint to world; empty: to be found
  bool is_krok = false;            // in Krok's unit and axes
  bool upright = false;            // the reference pose is +Y up and faces +Z, whatever the motion
  double usual_rate = 0;           // 0: unknown
  MotionKeys keys;
  std::size_t motions = 1;
  Diagnostics diagnostics;
};

// What is read, and how.
struct ArrayFile {
  const Arrays& arrays;
  const std::string& name;
  const ReadOptions& options;

  // The first of the names that the file has; empty if none.
  std::string find(std::initializer_list<const char*> names) const;
  // The numbers of an array, all finite (code npy-value). Shape as given: 0 is any size, which is
  // set.
  Result<std::vector<double>> numbers(const std::string& array,
                                      std::vector<std::size_t>& shape) const;
  Result<std::vector<double>> numbers(const std::string& array,
                                      std::vector<std::size_t>&& shape) const {
    return numbers(array, shape);
  }
  // A single number; empty if there is none of the names.
  Result<std::optional<double>> number(std::initializer_list<const char*> names) const;
};

// What the columns are: as given, or by their number.
Result<ArrangedSkeleton> skeleton_for(const ArrayFile& file, std::size_t columns,
                                      double& usual_rate, Diagnostics& diagnostics);

// Positions and orientations of frames from rotations relative to the parents, [frames x joints].
void pose_frames(const std::vector<Quat>& rotations, const std::vector<Vec3>& roots,
                 ArrayMotion& motion);

// Contacts of joints, as krok-export writes them, or of Kimodo's feet.
// `place`: of a joint in a frame, as the array has it; `column`: the contact's.
using PlaceOf = std::function<Vec3(std::size_t frame, std::size_t column, int joint)>;
Status add_contacts(const ArrayFile& file, double rate, std::size_t frames, const PlaceOf& place,
                    ArrayMotion& motion);

// Positions, [frames x joints x 3] or [motions x frames x joints x 3], of an array; of the only one
// for an empty name. Codes npy-shape, npy-skeleton, npy-value.
Result<ArrayMotion> motion_of_positions(const ArrayFile& file, const std::string& name);
// The same with rotation matrices of all joints, [frames x joints x 3 x 3], global or relative to
// the parents. Code npy-rotation, too.
Result<ArrayMotion> motion_of_rotations(const ArrayFile& file, const std::string& positions,
                                        const std::string& rotations, bool global);
Result<ArrayMotion> read_smpl(const ArrayFile& file);

// Null unless it is of length 1, within 1e-3.
std::optional<Quat> unit_quaternion(const Vec4& values);

// The frames of arrays as krok-export writes them, unpacked as they are read.
struct PackedFrames {
  std::size_t count = 0, joints = 0;
  // [count x contacts] of add_contacts().
  std::vector<Vec3f> contact_places;
  // Gives frames as the arrays have them, by one thread at a time.
  std::function<Status(std::size_t first, std::span<Vec3f> positions,
                       std::span<Quatf> orientations)>
      read;
};

// Of `frames`, if set, as many as the axes are found from. Fails then for an array that is not as
// krok-export writes it, too.
constexpr std::size_t kMaxSamples = 200;
std::size_t sampled_frame(std::size_t sample, std::size_t frames);
Result<ArrayMotion> read_krok(const ArrayFile& file, PackedFrames* frames = nullptr);

}  // namespace krok::npy
