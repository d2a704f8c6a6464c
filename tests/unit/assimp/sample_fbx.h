#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "math/transform.h"

// A small FBX in ASCII, by what is known of the format: two nodes with pivots that turn, and a mesh
// skinned to them with a morph target.

namespace krok::test {

inline Mat4 translation_matrix(const Vec3& t) {
  Mat4 m = Mat4::Identity();
  m.topRightCorner<3, 1>() = t;
  return m;
}

// Degrees, about x, then y, then z.
inline Mat4 euler_matrix(const Vec3& degrees) {
  const Vec3 a = degrees * kRadiansPerDegree;
  Mat4 m = Mat4::Identity();
  m.topLeftCorner<3, 3>() =
      (Eigen::AngleAxisd(a[2], Vec3::UnitZ()) * Eigen::AngleAxisd(a[1], Vec3::UnitY()) *
       Eigen::AngleAxisd(a[0], Vec3::UnitX()))
          .toRotationMatrix();
  return m;
}

struct FbxNode {
  std::string name;
  Vec3 translation = Vec3::Zero();
  Vec3 rotation = Vec3::Zero();
  Vec3 before = Vec3::Zero();  // PreRotation
  Vec3 after = Vec3::Zero();   // PostRotation
  Vec3 pivot = Vec3::Zero();   // RotationPivot
  std::vector<Vec3> keys;      // of the rotation, degrees

  // T Rp Rpre R Rpost^-1 Rp^-1, as Autodesk's "Computing transformation matrices" has it.
  Mat4 to_parent(const Vec3& turned) const {
    return translation_matrix(translation) * translation_matrix(pivot) * euler_matrix(before) *
           euler_matrix(turned) * euler_matrix(after).inverse() * translation_matrix(-pivot);
  }
};

struct FbxSample {
  // The first has what Assimp takes as one moving rotation, the second what it takes apart.
  std::vector<FbxNode> nodes = {{"Hips",
                                 {0, 100, 0},
                                 {10, 20, 30},
                                 {0, 0, 90},
                                 {40, 0, 15},
                                 {0, 0, 0},
                                 {{10, 20, 30}, {-40, 50, 80}, {20, -10, 60}}},
                                {"Spine",
                                 {0, 30, 5},
                                 {5, 0, 0},
                                 {-15, 30, 0},
                                 {0, 25, 0},
                                 {3, 4, 5},
                                 {{5, 0, 0}, {60, 20, -70}, {0, 90, 10}}}};
  std::vector<double> times = {0.0, 0.2, 0.75};
  // Of the square's last corner. The others' are along y and have the third axis along x, so that
  // it is on the left of normal x tangent; this one has it along y.
  std::string last_tangent = "1,0,0";

  std::string text() const;
};

inline std::string fbx_vector(const char* name, const char* type, const Vec3& v) {
  return fmt::format("P: \"{}\", \"{}\", \"\", \"A\",{},{},{}\n", name, type, v[0], v[1], v[2]);
}

inline std::string FbxSample::text() const {
  std::string out =
      "; FBX 7.4.0 project file\nFBXHeaderExtension:  {\nFBXHeaderVersion: 1003\nFBXVersion: 7400\n"
      "Creator: \"a test\"\n}\nGlobalSettings:  {\nVersion: 1000\nProperties70:  {\n"
      "P: \"UpAxis\", \"int\", \"Integer\", \"\",2\nP: \"UpAxisSign\", \"int\", \"Integer\", "
      "\"\",1\n"
      "P: \"FrontAxis\", \"int\", \"Integer\", \"\",1\n"
      "P: \"FrontAxisSign\", \"int\", \"Integer\", \"\",-1\n"
      "P: \"CoordAxis\", \"int\", \"Integer\", \"\",0\n"
      "P: \"CoordAxisSign\", \"int\", \"Integer\", \"\",1\n"
      "P: \"UnitScaleFactor\", \"double\", \"Number\", \"\",2.54\n"
      "P: \"TimeMode\", \"enum\", \"\", \"\",6\n}\n}\nObjects:  {\n";
  std::string links = "Connections:  {\n";
  const auto link = [&](long from, long to) {
    links += fmt::format("C: \"OO\",{},{}\n", from, to);
  };
  std::string key_times;
  for (const double time : times) {
    key_times +=
        fmt::format("{}{}", key_times.empty() ? "" : ",", std::llround(time * 46186158000.0));
  }
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const FbxNode& node = nodes[n];
    const long id = 1000 + static_cast<long>(n);
    out +=
        fmt::format("Model: {}, \"Model::{}\", \"LimbNode\" {{\nVersion: 232\nProperties70:  {{\n",
                    id, node.name);
    out += "P: \"RotationActive\", \"bool\", \"\", \"\",1\n";
    out += fbx_vector("Lcl Translation", "Lcl Translation", node.translation);
    out += fbx_vector("Lcl Rotation", "Lcl Rotation", node.rotation);
    out += fbx_vector("PreRotation", "Vector3D", node.before);
    out += fbx_vector("PostRotation", "Vector3D", node.after);
    out += fbx_vector("RotationPivot", "Vector3D", node.pivot);
    out += "}\nShading: Y\nCulling: \"CullingOff\"\n}\n";
    link(id, n == 0 ? 0 : id - 1);
    const long curves = 3000 + 10 * static_cast<long>(n);
    out += fmt::format("AnimationCurveNode: {}, \"AnimCurveNode::R\", \"\" {{\nProperties70:  {{\n",
                       curves);
    for (int axis = 0; axis < 3; ++axis) {
      out += fmt::format("P: \"d|{}\", \"Number\", \"\", \"A\",{}\n", "XYZ"[axis],
                         node.rotation[axis]);
    }
    out += "}\n}\n";
    link(curves, 2001);
    links += fmt::format("C: \"OP\",{},{}, \"Lcl Rotation\"\n", curves, id);
    for (int axis = 0; axis < 3; ++axis) {
      std::string values;
      for (const Vec3& key : node.keys)
        values += fmt::format("{}{}", values.empty() ? "" : ",", key[axis]);
      out += fmt::format(
          "AnimationCurve: {}, \"AnimCurve::\", \"\" {{\nDefault: 0\nKeyVer: 4008\n"
          "KeyTime: *{} {{\na: {}\n}}\nKeyValueFloat: *{} {{\na: {}\n}}\n}}\n",
          curves + 1 + axis, times.size(), key_times, node.keys.size(), values);
      links += fmt::format("C: \"OP\",{},{}, \"d|{}\"\n", curves + 1 + axis, curves, "XYZ"[axis]);
    }
  }
  out +=
      "AnimationStack: 2000, \"AnimStack::Take 001\", \"\" {\n}\n"
      "AnimationLayer: 2001, \"AnimLayer::Base\", \"\" {\n}\n";
  link(2001, 2000);
  // A square, skinned half and half, with a target that lifts its first corner.
  out +=
      "Model: 5000, \"Model::body\", \"Mesh\" {\nVersion: 232\n}\n"
      "Geometry: 5001, \"Geometry::body\", \"Mesh\" {\n"
      "Vertices: *12 {\na: 0,0,0,10,0,0,10,10,0,0,10,0\n}\n"
      "PolygonVertexIndex: *4 {\na: 0,1,2,-4\n}\nGeometryVersion: 124\n"
      "LayerElementNormal: 0 {\nVersion: 101\nName: \"\"\nMappingInformationType: "
      "\"ByPolygonVertex\"\nReferenceInformationType: \"Direct\"\nNormals: *12 {\n"
      "a: 0,0,1,0,0,1,0,0,1,0,0,1\n}\n}\n";
  const auto directions = [&](const std::string& name, const std::string& values) {
    out += fmt::format(
        "LayerElement{0}: 0 {{\nVersion: 101\nName: \"\"\nMappingInformationType: "
        "\"ByPolygonVertex\"\nReferenceInformationType: \"Direct\"\n{0}s: *12 {{\na: {1}\n}}\n}}\n",
        name, values);
  };
  directions("Tangent", "0,2,0,0,2,0,0,2,0," + last_tangent);
  directions("Binormal", "1,0,0,1,0,0,1,0,0,0,1,0");
  out += "Layer: 0 {\nVersion: 100\n";
  for (const char* name : {"Normal", "Tangent", "Binormal"}) {
    out += fmt::format("LayerElement:  {{\nType: \"LayerElement{}\"\nTypedIndex: 0\n}}\n", name);
  }
  out += "}\n}\n";
  link(5000, 0);
  link(5001, 5000);
  out += "Deformer: 6000, \"Deformer::\", \"Skin\" {\nVersion: 101\nLink_DeformAcuracy: 50\n}\n";
  link(6000, 5001);
  Mat4 world = Mat4::Identity();
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    world = world * nodes[n].to_parent(nodes[n].rotation);
    const auto numbers = [](const Mat4& m) {
      std::string text;
      for (int k = 0; k < 16; ++k) text += fmt::format("{}{:.10g}", k == 0 ? "" : ",", m.data()[k]);
      return text;
    };
    const long id = 6001 + static_cast<long>(n);
    out += fmt::format(
        "Deformer: {}, \"SubDeformer::\", \"Cluster\" {{\nVersion: 100\nIndexes: *4 {{\n"
        "a: 0,1,2,3\n}}\nWeights: *4 {{\na: {}\n}}\nTransform: *16 {{\na: {}\n}}\n"
        "TransformLink: *16 {{\na: {}\n}}\n}}\n",
        id, n == 0 ? "1,0.75,0.5,0.25" : "0,0.25,0.5,0.75", numbers(world.inverse()),
        numbers(world));
    link(id, 6000);
    link(1000 + static_cast<long>(n), id);
  }
  out +=
      "Geometry: 7002, \"Geometry::lifted\", \"Shape\" {\nVersion: 100\nIndexes: *1 {\na: 0\n}\n"
      "Vertices: *3 {\na: 0,0,2\n}\nNormals: *3 {\na: 0,0,0\n}\n}\n"
      "Deformer: 7000, \"Deformer::\", \"BlendShape\" {\nVersion: 100\n}\n"
      "Deformer: 7001, \"SubDeformer::lifted\", \"BlendShapeChannel\" {\nVersion: 100\n"
      "DeformPercent: 0\nFullWeights: *1 {\na: 100\n}\n}\n";
  link(7000, 5001);
  link(7001, 7000);
  link(7002, 7001);
  return out + "}\n" + links + "}\n";
}

}  // namespace krok::test
