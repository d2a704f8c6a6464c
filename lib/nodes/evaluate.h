#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/result.h"
#include "math/transform.h"
#include "nodes/scene.h"

// Evaluates a scene at a time of one of its animations, in double precision, as a viewer would show
// it: node transforms, then morph targets, then skinning with up to 8 influences per vertex.
// Source: glTF 2.0 Specification, sections 3.5, 3.7 and appendix C (interpolation).

namespace krok::nodes {

// A primitive of a mesh at a node of the displayed scene.
struct Instance {
  int node = 0;
  int mesh = 0;
  int primitive = 0;
};

struct Evaluation {
  std::vector<Mat4> node_to_world;           // [nodes]
  std::vector<std::vector<Vec3>> positions;  // [instances][vertices], world space
  std::vector<std::vector<Vec3>> normals;    // same shape, unit or zero; empty if not in the file
  bool with_tangents = false;                // set by the caller; if false, `tangents` is empty
  // Same shape, xyz unit or zero; w is the file's sign, negated for mirrored vertices.
  std::vector<std::vector<Vec4>> tangents;
  std::vector<Vec3> node_translations, node_scales;  // relative to the parent, [nodes]
  std::vector<Quat> node_rotations;
  std::vector<std::vector<double>> node_weights;  // morph target weights, [nodes]
  // Scratch memory.
  std::vector<double> values;
  std::vector<Eigen::Matrix<double, 3, 4>> palette;
};

// What a morph target at weight 1 adds to the vertices of an instance in world space, [vertices];
// empty where the target has none.
struct Displacements {
  std::vector<Vec3f> positions;          // metres
  std::vector<Vec3f> normals, tangents;  // in lengths of the undisplaced ones
};

// Evaluates one scene, which must outlive it. Const functions are thread-safe if each thread has
// its own Evaluation (which is reused to avoid allocations).
class Evaluator {
 public:
  // An Error (code scene-too-large) if the scene has too many vertices to hold, because many nodes
  // share a mesh.
  static Result<Evaluator> create(const Scene& scene);

  const std::vector<Instance>& instances() const { return instances_; }
  const Primitive& primitive(const Instance& instance) const;

  // The nodes that are joints of a skin, or all nodes of the scene if it has neither skins nor
  // meshes, except cameras and lights; parents before children.
  const std::vector<int>& joints() const { return joints_; }
  // For each of joints() the index in it of the nearest ancestor that is a joint, or -1.
  const std::vector<int>& joint_parents() const { return joint_parents_; }

  // All distinct key times of an animation, increasing; seconds.
  std::vector<double> key_times(int animation) const;

  // Fills `out`. animation -1: the nodes as in the file. Times are clamped to the first and last
  // key of each channel.
  void evaluate(int animation, double time, Evaluation& out) const;

  // Same for the nodes alone: fills node_to_world and the node_ members.
  void place_nodes(int animation, double time, Evaluation& out) const;

  // For an instance at a moment from place_nodes() or evaluate(): the sign of the determinant of
  // its node's global transform; if negative, its front faces are those wound clockwise (glTF 2.0,
  // section 3.7.4). 0 if it vanishes.
  int winding(const Instance& instance, const Evaluation& moment) const;

  // Fills `out` for a morph target of an instance at such a moment. False, without filling it, if
  // the vertices are placed by the identity: the displacements are those of the target itself.
  bool displace(const Instance& instance, std::size_t target, const Evaluation& moment,
                Displacements& out) const;

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

// The value of a channel at `time`; `values` has channel.width elements. Rotations are normalised.
void sample(const Channel& channel, double time, std::span<double> values);

// Position and orientation of a transform that may scale, mirror or shear: the rotation nearest to
// its linear part (negated first if it mirrors).
Transform rigid_part(const Mat4& matrix);

}  // namespace krok::nodes
