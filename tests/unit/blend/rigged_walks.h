#pragma once

#include <filesystem>
#include <string>

#include "core/file.h"
#include "formats/bvh/bvh_reader.h"
#include "formats/bvh/bvh_writer.h"
#include "math/quaternion.h"
#include "motion/hips_root.h"
#include "motion/travel.h"
#include "samples/generator/rig.h"
#include "unit/blend/blended_walks.h"

// The walks of tests of blending on the rigs that captures come with, and the ways in which the
// same walk may be stored otherwise.

namespace krok::blend {

using samples::Rig;

// Contacts are those of the joints of the same names.
inline KeyedWalk on_skeleton_of(Clip clip, const KeyedWalk& walk) {
  KeyedWalk result{std::move(clip), walk.keys};
  for (Contact& contact : result.keys.contacts) {
    const std::string& name = walk.clip.skeleton.names[static_cast<std::size_t>(contact.joint)];
    contact.joint = result.clip.skeleton.find(name);
    EXPECT_GE(contact.joint, 0) << name;
  }
  return result;
}

// A clip as it is when written to a capture and read again.
inline Clip through_a_file(const Clip& clip) {
  std::string path = (std::filesystem::temp_directory_path() / "krok-rig-XXXXXX").string();
  EXPECT_NE(mkdtemp(path.data()), nullptr);
  const std::string file = path + "/walk.bvh";
  auto output = OutputFile::create(file, {});
  EXPECT_TRUE(output.ok());
  EXPECT_TRUE(bvh::write(clip, {}, *output).ok());
  EXPECT_TRUE(output->commit().ok());
  const auto input = InputFile::open(file);
  EXPECT_TRUE(input.ok());
  auto read = bvh::read(input->text(), file, {});
  EXPECT_TRUE(read.ok()) << (read.ok() ? "" : read.error().message);
  std::filesystem::remove_all(path);
  return read.ok() ? std::move(read->clip) : Clip();
}

inline KeyedWalk rigged(const KeyedWalk& walk, Rig rig) {
  Clip clip = samples::with_rig(walk.clip, rig);
  return on_skeleton_of(rig == Rig::lying ? through_a_file(clip) : std::move(clip), walk);
}

inline KeyedWalk moved(KeyedWalk walk, const Transform& move) {
  move_clip(move, walk.clip);
  for (Contact& contact : walk.keys.contacts) contact.place = move * contact.place;
  return walk;
}

// Each joint's own axes turned, differently for each.
inline KeyedWalk with_other_axes(KeyedWalk walk) {
  const auto turn = [](std::size_t joint) {
    const auto j = static_cast<double>(joint);
    return from_rotation_vector({std::sin(3 * j), std::cos(5 * j), std::sin(7 * j + 1)});
  };
  Clip& clip = walk.clip;
  for (std::size_t j = 0; j < clip.skeleton.names.size(); ++j) {
    Quat& reference = clip.skeleton.reference[j].orientation;
    reference = reference * turn(j);
    for (int f = 0; f < clip.frame_count(); ++f) {
      Quatf& orientation = clip.frame_orientations(f)[j];
      orientation = (orientation.cast<double>() * turn(j)).normalized().cast<float>();
    }
  }
  return walk;
}

// Another reference pose of the same figure, from any frame of another motion; facing as before.
inline KeyedWalk with_reference_pose(KeyedWalk walk, const Clip& posed, int frame) {
  Skeleton& skeleton = walk.clip.skeleton;
  std::vector<Transform> pose(skeleton.names.size()), local(pose.size());
  posed.get_pose(frame, pose);
  world_to_local(skeleton.parents, pose, local);
  const int hips = carrying_joint(find_roles(skeleton));
  for (std::size_t j = static_cast<std::size_t>(hips) + 1; j < local.size(); ++j) {
    const int parent = skeleton.parents[j];
    skeleton.reference[j] = skeleton.reference[static_cast<std::size_t>(parent)] * local[j];
  }
  return walk;
}

// Metres between joints of the same names; joints that one of them lacks are not looked at.
inline double farthest_by_name(const Clip& a, const Clip& b) {
  EXPECT_EQ(a.frame_count(), b.frame_count());
  double most = 0;
  int looked_at = 0;
  for (int j = 0; j < a.joint_count(); ++j) {
    const int other = b.skeleton.find(a.skeleton.names[static_cast<std::size_t>(j)]);
    if (other < 0) continue;
    ++looked_at;
    for (int f = 0; f < std::min(a.frame_count(), b.frame_count()); ++f) {
      const Vec3f& p = a.frame_positions(f)[static_cast<std::size_t>(j)];
      const Vec3f& q = b.frame_positions(f)[static_cast<std::size_t>(other)];
      most = std::max<double>(most, (p - q).norm());
    }
  }
  EXPECT_GT(looked_at, 10);
  return most;
}

}  // namespace krok::blend
