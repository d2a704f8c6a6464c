#pragma once

#include <fmt/format.h>

#include <string>

#include "unit/assimp/sample_rig.h"

// The rig as Doom 3's MD5mesh and MD5anim, by the formats' description and without any library.

namespace krok::test {

// The three numbers of a unit quaternion whose fourth is negative.
inline std::string md5_rotation(const Quat& q) {
  const double sign = q.w() > 0 ? -1.0 : 1.0;
  return fmt::format("( {:.10f} {:.10f} {:.10f} )", sign * q.x(), sign * q.y(), sign * q.z());
}
inline std::string md5_vector(const Vec3& v) {
  return fmt::format("( {:.10f} {:.10f} {:.10f} )", v[0], v[1], v[2]);
}

inline std::string md5mesh(const MovingRig& rig) {
  const auto world = rig.to_world(rig.rest);
  std::string text = "MD5Version 10\ncommandline \"\"\n\nnumJoints 3\nnumMeshes 1\n\njoints {\n";
  for (std::size_t j = 0; j < world.size(); ++j) {
    text += fmt::format("\t\"{}\" {} {} {} // parent\n", rig.names[j], rig.parents[j],
                        md5_vector(world[j].position), md5_rotation(world[j].orientation));
  }
  text += "}\n\nmesh {\n\tshader \"skin\"\n\n\tnumverts 4\n";
  std::string weights;
  int count = 0;
  for (std::size_t c = 0; c < corners().size(); ++c) {
    text += fmt::format("\tvert {} ( 0.25 0.75 ) {} {}\n", c, count, corner_weights()[c].size());
    for (const auto& [joint, weight] : corner_weights()[c]) {
      const Vec3 local = world[static_cast<std::size_t>(joint)].inverse() * corners()[c];
      weights += fmt::format("\tweight {} {} {} {}\n", count++, joint, weight, md5_vector(local));
    }
  }
  text += "\n\tnumtris 2\n";
  for (std::size_t t = 0; t < corner_triangles().size(); ++t) {
    const auto triangle = corner_triangles()[t];  // clockwise
    text += fmt::format("\ttri {} {} {} {}\n", t, triangle[0], triangle[2], triangle[1]);
  }
  return text + fmt::format("\n\tnumweights {}\n", count) + weights + "}\n";
}

// Joint 0 moves and turns, joint 1 turns, joint 2 rests.
inline std::string md5anim(const MovingRig& rig) {
  std::string text = fmt::format(
      "MD5Version 10\ncommandline \"\"\n\nnumFrames {}\nnumJoints 3\nframeRate 24\n"
      "numAnimatedComponents 9\n\nhierarchy {{\n",
      rig.frames.size());
  const int flags[] = {63, 56, 0};
  const int starts[] = {0, 6, 9};
  for (std::size_t j = 0; j < 3; ++j) {
    text +=
        fmt::format("\t\"{}\" {} {} {} //\n", rig.names[j], rig.parents[j], flags[j], starts[j]);
  }
  text += "}\n\nbounds {\n";
  for (std::size_t f = 0; f < rig.frames.size(); ++f) text += "\t( -1 -1 -1 ) ( 1 1 1 )\n";
  text += "}\n\nbaseframe {\n";
  for (const Pose& pose : rig.frames[0]) {
    text += fmt::format("\t{} {}\n", md5_vector(pose.translation), md5_rotation(pose.rotation()));
  }
  text += "}\n\n";
  for (std::size_t f = 0; f < rig.frames.size(); ++f) {
    const auto numbers = [](std::string bracketed) {
      return bracketed.substr(1, bracketed.size() - 2);
    };
    const auto& poses = rig.frames[f];
    text += fmt::format(
        "frame {} {{\n\t{}\n\t{}\n\t{}\n}}\n\n", f, numbers(md5_vector(poses[0].translation)),
        numbers(md5_rotation(poses[0].rotation())), numbers(md5_rotation(poses[1].rotation())));
  }
  return text;
}

}  // namespace krok::test
