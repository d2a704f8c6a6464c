#pragma once

#include <fmt/format.h>

#include <sstream>
#include <string>

#include "unit/assimp/sample_rig.h"

// The rig as COLLADA, by its specification and without any library.

namespace krok::test {

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
