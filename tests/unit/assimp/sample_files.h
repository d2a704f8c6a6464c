#pragma once

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "math/transform.h"

// A small rig that moves, written in the formats that are read through Assimp, by their
// specifications and without any library; and where its joints are, by plain forward kinematics.

namespace krok::test {

// Rotations are of angles about x, then y, then z, each about the parent's axes, in radians.
struct Pose {
  Vec3 translation = Vec3::Zero();
  Vec3 angles = Vec3::Zero();

  Quat rotation() const {
    return Quat(Eigen::AngleAxisd(angles[2], Vec3::UnitZ()) *
                Eigen::AngleAxisd(angles[1], Vec3::UnitY()) *
                Eigen::AngleAxisd(angles[0], Vec3::UnitX()));
  }
  Transform transform() const { return {translation, rotation()}; }
};

// Joint 2 rests in every frame, in a pose that is not the mesh's.
struct MovingRig {
  std::vector<std::string> names = {"Hips", "Spine", "Head"};
  std::vector<int> parents = {-1, 0, 1};
  std::vector<Pose> rest = {{{0.1, 0.2, 1.0}, {0.1, -0.2, 0.3}},
                            {{0.0, 0.3, 0.5}, {0.7, 0.4, -0.5}},
                            {{0.1, 0.0, 0.4}, {0.0, 0.2, 0.1}}};
  std::vector<std::vector<Pose>> frames;  // [frames][joints]

  MovingRig() {
    for (int f = 0; f < 4; ++f) {
      std::vector<Pose> poses = rest;
      poses[0].translation += Vec3(0.1 * f, 0.02 * f * f, -0.05 * f);
      poses[0].angles += Vec3(0.2 * f, 0.1, -0.3 * f);
      poses[1].angles += Vec3(-0.4 * f, 0.3 * f, 0.5 * f);
      poses[2].translation = {0.2, 0.1, 0.3};
      poses[2].angles = {0.3, -0.6, 0.9};
      frames.push_back(std::move(poses));
    }
  }

  std::vector<Transform> to_world(const std::vector<Pose>& poses) const {
    std::vector<Transform> world;
    for (std::size_t j = 0; j < poses.size(); ++j) {
      const Transform local = poses[j].transform();
      world.push_back(parents[j] < 0 ? local : world[static_cast<std::size_t>(parents[j])] * local);
    }
    return world;
  }
};

// Weights of the four corners of the mesh, a list of joint and weight each.
inline const std::vector<std::vector<std::pair<int, double>>>& corner_weights() {
  static const std::vector<std::vector<std::pair<int, double>>> weights = {
      {{0, 1.0}}, {{0, 0.25}, {1, 0.75}}, {{1, 0.5}, {2, 0.3}, {0, 0.2}}, {{2, 1.0}}};
  return weights;
}
inline const std::vector<Vec3>& corners() {
  static const std::vector<Vec3> places = {
      {0, 0, 0.9}, {0.3, 0, 1.2}, {0.1, 0.5, 1.6}, {-0.2, 0.4, 1.9}};
  return places;
}
inline const std::vector<std::array<int, 3>>& corner_triangles() {
  static const std::vector<std::array<int, 3>> triangles = {{0, 1, 2}, {0, 2, 3}};
  return triangles;
}

// ---- Valve SMD ----

inline std::string smd(const MovingRig& rig, bool mesh, bool motion,
                       const std::string& material = "skin of.bmp") {
  std::string text = "// made for a test\nversion 1\nnodes\n";
  for (std::size_t j = 0; j < rig.names.size(); ++j) {
    text += fmt::format("  {} \"{}\" {}\n", j, rig.names[j], rig.parents[j]);
  }
  text += "end\nskeleton\n";
  const auto write_frame = [&](int time, const std::vector<Pose>& poses) {
    text += fmt::format("time {}\n", time);
    for (std::size_t j = 0; j < poses.size(); ++j) {
      const auto& [t, a] = poses[j];
      text += fmt::format("{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", j, t[0], t[1], t[2],
                          a[0], a[1], a[2]);
    }
  };
  if (motion) {
    // Frames at uneven times.
    const int times[] = {0, 1, 4, 6};
    for (std::size_t f = 0; f < rig.frames.size(); ++f) write_frame(times[f], rig.frames[f]);
  } else {
    write_frame(0, rig.rest);
  }
  text += "end\n";
  if (!mesh) return text;
  text += "triangles\n";
  for (const auto& triangle : corner_triangles()) {
    text += material + "\n";
    for (const int corner : triangle) {
      const Vec3 p = corners()[static_cast<std::size_t>(corner)];
      const auto weights = corner_weights()[static_cast<std::size_t>(corner)];
      text += fmt::format("0 {} {} {} 0 0 1 0.25 0.75 {}", p[0], p[1], p[2], weights.size());
      for (const auto& [joint, weight] : weights) text += fmt::format(" {} {}", joint, weight);
      text += "\n";
    }
  }
  return text + "end\n";
}

// ---- Doom 3 MD5 ----

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

// ---- Binary files ----

class BinaryText {
 public:
  template <typename T>
  BinaryText& put(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
    return *this;
  }
  BinaryText& text(std::string_view text, std::size_t size) {
    std::string fixed(text);
    fixed.resize(size);
    bytes_ += fixed;
    return *this;
  }
  BinaryText& vector(const Vec3& v) {
    for (int k = 0; k < 3; ++k) put(static_cast<float>(v[k]));
    return *this;
  }
  BinaryText& append(const std::string& bytes) {
    bytes_ += bytes;
    return *this;
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

// ---- MilkShape MS3D ----

// The frames are at 0, 0.1, 0.4 and 0.6 s. A key is relative to the joint's rest: rest * key is the
// joint's transform.
inline std::string ms3d(const MovingRig& rig, bool weights = true, float rate = 25.0f) {
  BinaryText out;
  out.text("MS3D000000", 10).put<std::int32_t>(4);
  out.put<std::uint16_t>(4);
  for (std::size_t c = 0; c < 4; ++c) {
    out.put<std::uint8_t>(0).vector(corners()[c]);
    out.put(static_cast<std::int8_t>(corner_weights()[c][0].first)).put<std::uint8_t>(1);
  }
  out.put<std::uint16_t>(2);
  for (const auto& triangle : corner_triangles()) {
    out.put<std::uint16_t>(0);
    for (const int corner : triangle) out.put(static_cast<std::uint16_t>(corner));
    for (int k = 0; k < 3; ++k) out.vector({0, 0, 1});
    for (int k = 0; k < 3; ++k) out.put(0.25f);
    for (int k = 0; k < 3; ++k) out.put(0.75f);
    out.put<std::uint8_t>(1).put<std::uint8_t>(0);
  }
  out.put<std::uint16_t>(1).put<std::uint8_t>(0).text("body", 32);
  out.put<std::uint16_t>(2).put<std::uint16_t>(0).put<std::uint16_t>(1).put<std::int8_t>(0);
  out.put<std::uint16_t>(1).text("skin", 32);
  for (int k = 0; k < 18; ++k) out.put(0.5f);
  out.put<std::uint8_t>(0).text("", 256);
  out.put(rate).put(0.0f).put<std::int32_t>(16);
  out.put(static_cast<std::uint16_t>(rig.names.size()));
  const float times[] = {0.0f, 0.1f, 0.4f, 0.6f};
  for (std::size_t j = 0; j < rig.names.size(); ++j) {
    const Transform rest = rig.rest[j].transform();
    out.put<std::uint8_t>(0).text(rig.names[j], 32);
    out.text(j == 0 ? "" : rig.names[static_cast<std::size_t>(rig.parents[j])], 32);
    out.vector(rig.rest[j].angles).vector(rig.rest[j].translation);
    out.put(static_cast<std::uint16_t>(rig.frames.size()));
    out.put(static_cast<std::uint16_t>(rig.frames.size()));
    std::string positions;
    for (std::size_t f = 0; f < rig.frames.size(); ++f) {
      const Transform key = rest.inverse() * rig.frames[f][j].transform();
      const Vec3 zyx = key.orientation.toRotationMatrix().eulerAngles(2, 1, 0);
      out.put(times[f]).vector({zyx[2], zyx[1], zyx[0]});
      positions += BinaryText().put(times[f]).vector(key.position).take();
    }
    out.append(positions);
  }
  if (!weights) return out.take();
  // No groups', materials' and joints' comments but one of the model.
  out.put<std::uint32_t>(1).put<std::uint32_t>(0).put<std::uint32_t>(0).put<std::uint32_t>(0);
  out.put<std::uint32_t>(1).put<std::uint32_t>(5).text("hello", 5);
  out.put<std::uint32_t>(2);
  for (const auto& list : corner_weights()) {
    for (std::size_t k = 1; k < 4; ++k) {
      out.put(static_cast<std::int8_t>(k < list.size() ? list[k].first : -1));
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const double weight = k < list.size() ? list[k].second : 0.0;
      out.put(static_cast<std::uint8_t>(std::lround(weight * 100)));
    }
    out.put<std::uint32_t>(0);
  }
  return out.take();
}

// ---- 3DS ----

inline std::string chunk(std::uint16_t id, const std::string& content) {
  return BinaryText()
      .put(id)
      .put(static_cast<std::uint32_t>(content.size() + 6))
      .append(content)
      .take();
}

// A mesh "body" that moves along x in three uneven keys (frames 0, 4 and 10), and a camera "eye" at
// (0, -5, 1) that looks at (0, 0, 1) through a lens of 50 mm, rolled by `roll` degrees.
inline std::string max_3ds(float roll = 0.0f) {
  BinaryText points, faces, matrix;
  points.put<std::uint16_t>(4);
  for (const Vec3& corner : corners()) points.vector(corner);
  faces.put<std::uint16_t>(2);
  for (const auto& triangle : corner_triangles()) {
    for (const int corner : triangle) faces.put(static_cast<std::uint16_t>(corner));
    faces.put<std::uint16_t>(7);
  }
  matrix.vector(Vec3::UnitX()).vector(Vec3::UnitY()).vector(Vec3::UnitZ()).vector({0, 0, 0});
  const std::string body =
      std::string("body\0", 5) +
      chunk(0x4100, chunk(0x4110, points.take()) + chunk(0x4120, faces.take()) +
                        chunk(0x4160, matrix.take()));
  const std::string eye =
      std::string("eye\0", 4) +
      chunk(0x4700, BinaryText().vector({0, -5, 1}).vector({0, 0, 1}).put(roll).put(50.0f).take());
  const std::string editor = chunk(0x3D3D, chunk(0x4000, body) + chunk(0x4000, eye));
  const auto track = [](const std::vector<std::pair<int, std::string>>& keys) {
    BinaryText out;
    out.put<std::uint16_t>(0).put<std::uint32_t>(0).put<std::uint32_t>(0);
    out.put(static_cast<std::uint32_t>(keys.size()));
    for (const auto& [frame, value] : keys) {
      out.put(static_cast<std::uint32_t>(frame)).put<std::uint16_t>(0).append(value);
    }
    return out.take();
  };
  const auto at = [](double x) { return BinaryText().vector({x, 0, 0}).take(); };
  const std::string still = BinaryText().put(0.0f).vector({0, 0, 1}).take();
  const std::string whole = BinaryText().vector({1, 1, 1}).take();
  const std::string node =
      chunk(0xB030, BinaryText().put<std::uint16_t>(0).take()) +
      chunk(0xB010, std::string("body\0", 5) +
                        BinaryText().put<std::uint32_t>(0).put<std::uint16_t>(0xFFFF).take()) +
      chunk(0xB013, BinaryText().vector({0, 0, 0}).take()) +
      chunk(0xB020, track({{0, at(0)}, {4, at(0.5)}, {10, at(2)}})) +
      chunk(0xB021, track({{0, still}})) + chunk(0xB022, track({{0, whole}}));
  const std::string keyframer = chunk(0xB000, chunk(0xB002, node));
  return chunk(0x4D4D,
               chunk(0x0002, BinaryText().put<std::uint32_t>(3).take()) + editor + keyframer);
}

// ---- ASE ----

// A mesh "body" that moves and turns by samples at uneven times (ticks of 1/4800 s), and a camera.
inline std::string ase() {
  std::string text =
      "*3DSMAX_ASCIIEXPORT\t200\n*COMMENT \"made for a test\"\n*SCENE {\n\t*SCENE_FILENAME \"\"\n"
      "\t*SCENE_FIRSTFRAME 0\n\t*SCENE_LASTFRAME 30\n\t*SCENE_FRAMESPEED 30\n"
      "\t*SCENE_TICKSPERFRAME 160\n}\n";
  text +=
      "*GEOMOBJECT {\n\t*NODE_NAME \"body\"\n\t*NODE_TM {\n\t\t*NODE_NAME \"body\"\n"
      "\t\t*TM_ROW0 1 0 0\n\t\t*TM_ROW1 0 1 0\n\t\t*TM_ROW2 0 0 1\n\t\t*TM_ROW3 0 0 0\n\t}\n"
      "\t*MESH {\n\t\t*TIMEVALUE 0\n\t\t*MESH_NUMVERTEX 4\n\t\t*MESH_NUMFACES 2\n"
      "\t\t*MESH_VERTEX_LIST {\n";
  for (std::size_t c = 0; c < 4; ++c) {
    const Vec3 p = corners()[c];
    text += fmt::format("\t\t\t*MESH_VERTEX {} {} {} {}\n", c, p[0], p[1], p[2]);
  }
  text += "\t\t}\n\t\t*MESH_FACE_LIST {\n";
  for (std::size_t t = 0; t < 2; ++t) {
    const auto triangle = corner_triangles()[t];
    text += fmt::format(
        "\t\t\t*MESH_FACE {}: A: {} B: {} C: {} AB: 1 BC: 1 CA: 1\t*MESH_SMOOTHING 1 "
        "\t*MESH_MTLID 0\n",
        t, triangle[0], triangle[1], triangle[2]);
  }
  text +=
      "\t\t}\n\t}\n\t*TM_ANIMATION {\n\t\t*NODE_NAME \"body\"\n\t\t*CONTROL_POS_TRACK {\n"
      "\t\t\t*CONTROL_POS_SAMPLE 0 0 0 0\n\t\t\t*CONTROL_POS_SAMPLE 640 1 0 0\n"
      "\t\t\t*CONTROL_POS_SAMPLE 4800 1 2 0\n\t\t}\n\t\t*CONTROL_ROT_TRACK {\n"
      "\t\t\t*CONTROL_ROT_SAMPLE 0 0 0 1 0\n\t\t\t*CONTROL_ROT_SAMPLE 640 0 0 1 0.5\n"
      "\t\t\t*CONTROL_ROT_SAMPLE 4800 0 0 1 0.25\n\t\t}\n\t}\n}\n";
  text +=
      "*CAMERAOBJECT {\n\t*NODE_NAME \"eye\"\n\t*CAMERA_TYPE Free\n\t*NODE_TM {\n"
      "\t\t*NODE_NAME \"eye\"\n\t\t*TM_ROW0 1 0 0\n\t\t*TM_ROW1 0 0 1\n\t\t*TM_ROW2 0 -1 0\n"
      "\t\t*TM_ROW3 0 -5 1\n\t}\n\t*CAMERA_SETTINGS {\n\t\t*TIMEVALUE 0\n\t\t*CAMERA_NEAR 0\n"
      "\t\t*CAMERA_FAR 1000\n\t\t*CAMERA_FOV 0.8\n\t\t*CAMERA_TDIST 5\n\t}\n}\n";
  return text;
}

// ---- COLLADA ----

// `params` are the names of what a stride holds, apart by spaces.
inline std::string collada_source(const std::string& id, const std::string& params,
                                  const std::string& values, int count, int stride,
                                  const std::string& type, const std::string& element) {
  std::string param_elements;
  std::istringstream names(params);
  for (std::string name; names >> name;) {
    param_elements += fmt::format("<param name=\"{}\" type=\"{}\"/>", name, type);
  }
  return fmt::format(
      "<source id=\"{0}\"><{1} id=\"{0}-data\" count=\"{2}\">{3}</{1}><technique_common>"
      "<accessor source=\"#{0}-data\" count=\"{4}\" stride=\"{5}\">{6}</accessor>"
      "</technique_common></source>\n",
      id, element, count * stride, values, count, stride, param_elements);
}

inline std::string matrix_text(const Mat4& m) {
  std::string text;
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) text += fmt::format("{:.9g} ", m(r, c));
  }
  return text;
}

// Z-up, in centimetres. Joints are nodes with ids that differ from their names. Hips has a matrix
// with a curve of its own; Spine a translation, and rotations about z, y and x with curves in two
// <animation>s of different lengths; Head rests. The camera gives its vertical field of view alone.
inline std::string collada(const MovingRig& rig, bool with_unit = true) {
  constexpr double kDegrees = 180.0 / kPi;
  std::string text =
      "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"
      "<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">\n"
      "<asset><created>2020-01-01T00:00:00</created><modified>2020-01-01T00:00:00</modified>";
  if (with_unit) text += "<unit name=\"centimeter\" meter=\"0.01\"/>";
  text += "<up_axis>Z_UP</up_axis></asset>\n";
  text +=
      "<library_cameras><camera id=\"eye-camera\"><optics><technique_common><perspective>"
      "<yfov>40</yfov><znear>0.1</znear><zfar>100</zfar></perspective></technique_common>"
      "</optics></camera></library_cameras>\n";
  std::string points, faces;
  for (const Vec3& p : corners()) points += fmt::format("{} {} {} ", p[0], p[1], p[2]);
  for (const auto& triangle : corner_triangles()) {
    for (const int corner : triangle) faces += fmt::format("{} ", corner);
  }
  text += "<library_geometries><geometry id=\"body\" name=\"body\"><mesh>\n" +
          collada_source("body-positions", "X Y Z", points, 4, 3, "float", "float_array");
  text +=
      "<vertices id=\"body-vertices\"><input semantic=\"POSITION\" "
      "source=\"#body-positions\"/></vertices><triangles count=\"2\"><input "
      "semantic=\"VERTEX\" source=\"#body-vertices\" offset=\"0\"/><p>" +
      faces + "</p></triangles></mesh></geometry></library_geometries>\n";
  std::string binds, weights, counts, pairs;
  const auto world = rig.to_world(rig.rest);
  for (const Transform& joint : world) binds += matrix_text(joint.inverse().matrix());
  int weight_count = 0;
  for (const auto& list : corner_weights()) {
    counts += fmt::format("{} ", list.size());
    for (const auto& [joint, weight] : list) {
      weights += fmt::format("{} ", weight);
      pairs += fmt::format("{} {} ", joint, weight_count++);
    }
  }
  text +=
      "<library_controllers><controller id=\"rig-skin\"><skin source=\"#body\">"
      "<bind_shape_matrix>" +
      matrix_text(Mat4::Identity()) + "</bind_shape_matrix>\n";
  text += collada_source("rig-joints", "JOINT", "Hips Spine Head", 3, 1, "name", "Name_array");
  text += collada_source("rig-binds", "TRANSFORM", binds, 3, 16, "float4x4", "float_array");
  text += collada_source("rig-weights", "WEIGHT", weights, weight_count, 1, "float", "float_array");
  text +=
      "<joints><input semantic=\"JOINT\" source=\"#rig-joints\"/><input "
      "semantic=\"INV_BIND_MATRIX\" source=\"#rig-binds\"/></joints><vertex_weights "
      "count=\"4\"><input semantic=\"JOINT\" source=\"#rig-joints\" offset=\"0\"/><input "
      "semantic=\"WEIGHT\" source=\"#rig-weights\" offset=\"1\"/><vcount>" +
      counts + "</vcount><v>" + pairs +
      "</v></vertex_weights></skin></controller></library_controllers>\n";
  // Curves.
  const auto animation = [](const std::string& id, const std::string& times, int count,
                            const std::string& values, int stride, const std::string& type,
                            const std::string& target) {
    std::string out = "<animation id=\"" + id + "\">\n";
    out += collada_source(id + "-input", "TIME", times, count, 1, "float", "float_array");
    out += collada_source(id + "-output", "X", values, count, stride, type, "float_array");
    std::string linear;
    for (int k = 0; k < count; ++k) linear += "LINEAR ";
    out += collada_source(id + "-interpolation", "INTERPOLATION", linear, count, 1, "name",
                          "Name_array");
    out += fmt::format(
        "<sampler id=\"{0}-sampler\"><input semantic=\"INPUT\" source=\"#{0}-input\"/><input "
        "semantic=\"OUTPUT\" source=\"#{0}-output\"/><input semantic=\"INTERPOLATION\" "
        "source=\"#{0}-interpolation\"/></sampler><channel source=\"#{0}-sampler\" "
        "target=\"{1}\"/></animation>\n",
        id, target);
    return out;
  };
  std::string matrices;
  for (const auto& poses : rig.frames) matrices += matrix_text(poses[0].transform().matrix());
  text += "<library_animations>\n";
  text +=
      animation("hips-motion", "0 0.1 0.4 0.6", 4, matrices, 16, "float4x4", "rig_Hips/transform");
  const char* const axes[] = {"X", "Y", "Z"};
  for (int axis = 0; axis < 3; ++axis) {
    // The y curve lacks its last key.
    const int count = axis == 1 ? 3 : 4;
    std::string angles;
    for (int f = 0; f < count; ++f) {
      angles += fmt::format("{:.9g} ",
                            rig.frames[static_cast<std::size_t>(f)][1].angles[axis] * kDegrees);
    }
    text +=
        animation(fmt::format("spine-{}", axes[axis]), count == 3 ? "0 0.1 0.4" : "0 0.1 0.4 0.6",
                  count, angles, 1, "float", fmt::format("rig_Spine/rotate{}.ANGLE", axes[axis]));
  }
  text += "</library_animations>\n";
  // Nodes.
  const Pose& spine = rig.rest[1];
  text += "<library_visual_scenes><visual_scene id=\"Scene\" name=\"Scene\">\n";
  text +=
      "<node id=\"rig_Hips\" name=\"Hips\" sid=\"Hips\" type=\"JOINT\"><matrix "
      "sid=\"transform\">" +
      matrix_text(rig.rest[0].transform().matrix()) + "</matrix>\n";
  text += fmt::format(
      "<node id=\"rig_Spine\" name=\"Spine\" sid=\"Spine\" type=\"JOINT\"><translate "
      "sid=\"translate\">{} {} {}</translate><rotate sid=\"rotateZ\">0 0 1 {:.9g}</rotate><rotate "
      "sid=\"rotateY\">0 1 0 {:.9g}</rotate><rotate sid=\"rotateX\">1 0 0 {:.9g}</rotate>\n",
      spine.translation[0], spine.translation[1], spine.translation[2], spine.angles[2] * kDegrees,
      spine.angles[1] * kDegrees, spine.angles[0] * kDegrees);
  text +=
      "<node id=\"rig_Head\" name=\"Head\" sid=\"Head\" type=\"JOINT\"><matrix "
      "sid=\"transform\">" +
      matrix_text(rig.rest[2].transform().matrix()) + "</matrix></node>\n</node>\n</node>\n";
  text +=
      "<node id=\"body-node\" name=\"body\"><instance_controller url=\"#rig-skin\"><skeleton>"
      "#rig_Hips</skeleton></instance_controller></node>\n";
  text +=
      "<node id=\"eye-node\" name=\"eye\"><translate sid=\"translate\">0 -5 1</translate>"
      "<rotate sid=\"rotateX\">1 0 0 90</rotate><instance_camera url=\"#eye-camera\"/></node>\n"
      "</visual_scene></library_visual_scenes>\n<scene><instance_visual_scene "
      "url=\"#Scene\"/></scene>\n</COLLADA>\n";
  return text;
}

}  // namespace krok::test
