#include "character/rig.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "capture/unique_names.h"
#include "character/space.h"
#include "core/index.h"
#include "core/numbers.h"
#include "core/text.h"

namespace krok::character {

using nodes::Scene;

namespace {

// Names that mark the end of a bone: "Head_end", "HeadTop_End", "L Finger0Nub".
bool names_an_end(const std::string& name) {
  const std::string lower = ascii_lower(name);
  for (const char* ending : {"_end", ".end", " end", "_end_site", " nub", "_nub", "endsite"}) {
    if (lower.ends_with(ending)) return true;
  }
  return name.ends_with("Nub") || name.ends_with("End");
}

class RigBuilder {
 public:
  RigBuilder(const Scene& scene, Diagnostics& diagnostics, Rig rig)
      : scene_(scene), diagnostics_(diagnostics), rig_(std::move(rig)) {}

  Result<Rig> build(const std::vector<char>& weighted) {
    if (Status status = fold_scales(); !status) return status.error();
    name_joints();
    mark_ends(weighted);
    return std::move(rig_);
  }

 private:
  Status fold_scales();
  void name_joints();
  void mark_ends(const std::vector<char>& weighted);

  const Scene& scene_;
  Diagnostics& diagnostics_;
  Rig rig_;
};

Status RigBuilder::fold_scales() {
  for (int j = 0; j < rig_.joints.count(); ++j) {
    const Mat4& reference = rig_.reference[at(j)];
    if (!reference.allFinite() || reference.cwiseAbs().maxCoeff() > 1e30) {
      return Error("scene-value", "the bind pose transforms are not finite or too large",
                   "the file is damaged or its exporter is faulty");
    }
    const Transform rigid = nodes::rigid_part(reference);
    Mat4 scale = Mat4::Identity();
    scale.topLeftCorner<3, 3>() =
        rigid.orientation.toRotationMatrix().transpose() * reference.topLeftCorner<3, 3>();
    rig_.unscale.push_back(inverse_or_identity(scale).topLeftCorner<3, 3>());
    rig_.skeleton.add({}, rig_.joints.parents[at(j)], rigid);
  }
  return {};
}

void RigBuilder::name_joints() {
  UniqueNames names;
  std::vector<std::string> given(at(rig_.joints.count()));
  std::vector<char> unique(given.size(), 0);
  for (std::size_t j = 0; j < given.size(); ++j) {
    const int node = rig_.joints.nodes[j];
    given[j] = node < 0 ? "Roots" : to_utf8(scene_.nodes[at(node)].name);
    unique[j] = !given[j].empty() && names.claim(given[j]);
  }
  std::vector<std::string> examples;
  std::size_t unnamed = 0, renamed = 0;
  for (std::size_t j = 0; j < given.size(); ++j) {
    std::string& name = rig_.skeleton.names[j];
    name = given[j];
    if (unique[j]) continue;
    const bool empty = name.empty();
    ++(empty ? unnamed : renamed);
    name = names.make(empty ? fmt::format("node_{}", rig_.joints.nodes[j]) : name);
    if (!empty && examples.size() < 3) {
      examples.push_back(fmt::format("{} to {}", shown(given[j]), shown(name)));
    }
  }
  if (renamed > 0) {
    diagnostics_.push_back(make_warning(
        "scene-joint-names",
        fmt::format("{} with a duplicate name {} renamed: {}{}",
                    counted(static_cast<long long>(renamed), "joint"), renamed == 1 ? "is" : "are",
                    fmt::join(examples, ", "), renamed > examples.size() ? ", ..." : "")));
  }
  if (unnamed > 0) {
    diagnostics_.push_back(
        make_diagnostic(Severity::note, "scene-joint-names",
                        fmt::format("{} without a name {} named by node number",
                                    counted(static_cast<long long>(unnamed), "joint"),
                                    unnamed == 1 ? "is" : "are")));
  }
  if (rig_.joints.nodes[0] < 0) {
    diagnostics_.push_back(make_warning(
        "scene-roots",
        fmt::format("the joints have no common ancestor; a root joint {} was added at the "
                    "origin",
                    shown(rig_.skeleton.names[0]))));
  }
}

// Marks leaves that are named as ends, carry no vertices and never rotate.
void RigBuilder::mark_ends(const std::vector<char>& weighted) {
  std::vector<char> other(rig_.skeleton.names.size(), 0);
  for (const int parent : rig_.joints.parents) {
    if (parent >= 0) other[at(parent)] = 1;
  }
  for (const nodes::Animation& animation : scene_.animations) {
    for (const nodes::Channel& channel : animation.channels) {
      const int joint = rig_.joints.node_to_joint[at(channel.node)];
      if (joint < 0 || rig_.joints.nodes[at(joint)] != channel.node) continue;
      if (channel.path != nodes::Path::rotation) continue;
      const std::vector<float>& values = *channel.values;
      const auto width = static_cast<std::size_t>(channel.width);
      // Cubic splines have in-tangent, value and out-tangent per key.
      const bool spline = channel.interpolation == nodes::Interpolation::cubic_spline;
      const std::size_t parts = spline ? 3 : 1;
      for (std::size_t i = 0; i < values.size(); ++i) {
        const bool is_tangent = spline && i / width % parts != 1;
        const float still = is_tangent ? 0.0f : values[(parts / 2) * width + i % width];
        if (std::abs(values[i] - still) > 1e-5f) other[at(joint)] = 1;
      }
    }
  }
  for (std::size_t j = 1; j < other.size(); ++j) {
    rig_.skeleton.end_sites[j] = !other[j] && !weighted[j] && names_an_end(rig_.skeleton.names[j]);
  }
}

// The factor of a matrix that scales all axes alike; 0 for another.
double uniform_scale(const Mat3& linear) {
  const double scale = linear.col(0).norm();
  const bool uniform = (linear.transpose() * linear - scale * scale * Mat3::Identity()).norm() <
                       1e-6 * scale * scale;
  return uniform && linear.determinant() > 0 ? scale : 0.0;
}

// Exporters write any matrix for joints without vertices, which scales nothing that is seen: such a
// joint is rigid as its node stands without animation.
void scale_by_nodes(const nodes::Evaluator& evaluator, const std::vector<char>& weighted,
                    Rig& rig) {
  nodes::Evaluation rest;
  evaluator.place_nodes(-1, 0, rest);
  for (int j = 0; j < rig.joints.count(); ++j) {
    const int node = rig.joints.nodes[at(j)];
    if (weighted[at(j)] != 0 || node < 0) continue;
    const double shown = uniform_scale(rest.node_to_world[at(node)].topLeftCorner<3, 3>());
    if (shown > 0 && uniform_scale(rig.unscale[at(j)]) > 0) {
      rig.unscale[at(j)] = Mat3::Identity() / shown;
    }
  }
}

}  // namespace

Mat4 Rig::joint_to_world(const nodes::Evaluation& state, int joint) const {
  const int node = joints.nodes[at(joint)];
  if (node < 0) return to_axes;
  Mat4 result = to_axes * state.node_to_world[at(node)];
  result.topLeftCorner<3, 3>() = (result.topLeftCorner<3, 3>() * unscale[at(joint)]).eval();
  return result;
}

Result<Rig> make_rig(const Scene& scene, const nodes::Evaluator& evaluator, Joints joints,
                     Diagnostics& diagnostics) {
  Rig rig;
  rig.joints = std::move(joints);
  rig.has_mesh = !scene.meshes.empty();
  rig.to_axes = rotation_to_apply(scene.space);
  BindPose bind = find_bind_pose(scene, evaluator, rig.joints, rig.to_axes, diagnostics);
  rig.reference = std::move(bind.joint_to_world);
  auto built = RigBuilder(scene, diagnostics, std::move(rig)).build(bind.weighted);
  if (built) scale_by_nodes(evaluator, bind.weighted, *built);
  return built;
}

}  // namespace krok::character
