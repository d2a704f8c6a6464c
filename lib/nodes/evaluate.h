#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/result.h"
#include "math/transform.h"
#include "nodes/scene.h"

// A scene at a moment of one of its animations, in doubles: what a viewer would show.
// Nodes are placed by their (animated) transforms, then morph targets are added, then vertices are
// skinned with up to 8 influences each. Source: glTF 2.0 Specification, sections 3.5, 3.7 and
// appendix C (interpolation).

namespace krok::nodes {

// A primitive of a mesh at a node of the scene that is shown.
struct Instance {
  int node = 0;
  int mesh = 0;
  int primitive = 0;
};

struct Evaluation {
  std::vector<Mat4> node_to_world;           // [nodes]
  std::vector<std::vector<Vec3>> positions;  // [instances][vertices], world space
  std::vector<std::vector<Vec3>> normals;    // the same, unit or zero; none where the file has none
  bool with_tangents = false;                // set by who wants them; otherwise `tangents` has none
  // The same, xyz unit or zero; w is the file's sign, turned round where vertices are mirrored.
  std::vector<std::vector<Vec4>> tangents;
  std::vector<Vec3> node_translations, node_scales;  // to the parent, [nodes]
  std::vector<Quat> node_rotations;
  std::vector<std::vector<double>> node_weights;  // of the mesh's targets, [nodes]
  // Working space.
  std::vector<double> values;
  std::vector<Eigen::Matrix<double, 3, 4>> palette;
};

// Evaluates one scene, which must outlive it. Const functions may be called from many threads,
// each with an Evaluation of its own (which is reused to save allocations).
class Evaluator {
 public:
  // An Error (code scene-too-large) if the scene shows so many vertices, because many nodes have
  // the same mesh, that they could not be held.
  static Result<Evaluator> create(const Scene& scene);

  const std::vector<Instance>& instances() const { return instances_; }
  const Primitive& primitive(const Instance& instance) const;

  // The nodes that are a skin's joints, or all nodes of the scene if it has neither skins nor
  // meshes; in an order with parents before children.
  const std::vector<int>& joints() const { return joints_; }
  // For each of joints() the place in it of the nearest ancestor that is a joint too, or -1.
  const std::vector<int>& joint_parents() const { return joint_parents_; }

  // All key times of an animation, each once, rising; seconds.
  std::vector<double> key_times(int animation) const;

  // Fills `out`. animation -1: the nodes as the file has them. Before the first key of a channel
  // its first value holds, after the last the last.
  void evaluate(int animation, double time, Evaluation& out) const;

  // The same for the nodes alone: fills node_to_world and the node_ members.
  void place_nodes(int animation, double time, Evaluation& out) const;

  // All nodes, parents before children: depth first through the scene, then those outside of it.
  const std::vector<int>& order() const { return order_; }

 private:
  explicit Evaluator(const Scene& scene) : scene_(&scene) {}
  void order_nodes();
  Status find_instances();
  void find_joints();
  void evaluate_instance(std::size_t index, Evaluation& out) const;

  const Scene* scene_;
  std::vector<int> order_;  // all nodes, parents before children
  std::vector<Instance> instances_;
  std::vector<int> joints_, joint_parents_;
};

// The value of a channel at `time`; `values` has channel.width elements. Rotations come out unit.
void sample(const Channel& channel, double time, std::span<double> values);

// Position and orientation of a transform that may scale, mirror or shear: the nearest rotation to
// its linear part (mirrored back where it mirrors).
Transform rigid_part(const Mat4& matrix);

}  // namespace krok::nodes
