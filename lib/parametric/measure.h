#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "parametric/packed_examples.h"

namespace krok::parametric {

// Measures the parameters f(w) of a blend. The examples' poses at the keytimes are summed with the
// weights (positions; rotations in one hemisphere, normalised), then forward kinematics along the
// joints needed gives the parameters, relative to the blend's own stance footprint. Equal to what
// is measured on a BlendedMotion, except for its float rounding.
class Measure {
 public:
  // The library must be valid, with at least one example. No reference to the arguments is kept.
  Measure(const Library& library, const PackedExamples& packed);

  int examples() const { return examples_; }
  int dimensions() const { return static_cast<int>(parameters_.size()); }

  struct NodeState {
    double length = 0;                 // of the sum of rotations
    Quat rotation = Quat::Identity();  // joint to parent
    Transform to_world;
    Vec3 force, moment;
  };
  using Scratch = std::vector<NodeState>;
  Scratch make_scratch() const { return Scratch(nodes_.size()); }

  // `weights`: [examples], summing to 1. `parameters`: [dimensions], metres, radians, seconds.
  // `jacobian`: [dimensions x examples], row-major, derivatives of the parameters by the weights,
  // or empty. Does not allocate; thread-safe with one scratch per thread. Codes: parametric-sum if
  // rotations cancel (a sum shorter than 1e-6), parametric-foot if a foot is vertical, so that it
  // has no heading.
  Status operator()(std::span<const double> weights, std::span<double> parameters,
                    std::span<double> jacobian, Scratch& scratch) const;

 private:
  // A joint at a keytime.
  struct Node {
    int keytime = 0;
    int joint = 0;
    int parent = -1;     // index of a node
    bool moves = false;  // whether its position in its parent differs between the examples
    Vec3 place = Vec3::Zero();
  };
  struct Print;
  struct Pull;

  int node(int keytime, int joint) const;
  void add_nodes(const Library& library, std::vector<std::vector<std::uint8_t>>& needed);
  void fill_nodes(const PackedExamples& packed);
  Status pose(const Eigen::Ref<const Eigen::VectorXd>& weights, Scratch& scratch) const;
  Status print_of(const FootShape& foot, int node, const Scratch& scratch, Print& print) const;
  void pull(const Print& print, const Vec3& place, double heading, Scratch& scratch) const;
  Status evaluate(const Parameter& parameter, const Print& stance, Scratch& scratch, double& value,
                  bool gradient) const;
  void gather(Scratch& scratch, Eigen::Ref<Eigen::RowVectorXd> row) const;

  int examples_ = 0;
  double side_ = 1;  // +1 if the swing foot is the left one
  FootShape stance_, swing_;
  std::vector<Parameter> parameters_;
  std::vector<Node> nodes_;    // by keytime; parents before their children
  Eigen::MatrixXd rotations_;  // [examples x (4 * nodes)], x y z w
  Eigen::MatrixXd places_;     // [examples x (3 * nodes)]
  Eigen::VectorXd durations_;  // [examples], seconds
};

}  // namespace krok::parametric
