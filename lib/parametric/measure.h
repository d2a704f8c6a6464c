#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "parametric/packed_examples.h"

namespace krok::parametric {

// The parameters of the motion that weights blend: f(w). The examples' poses at the keytimes are
// summed with their weights (positions and, in one hemisphere, rotations brought to length 1), and
// what is measured is worked out by forward kinematics along the joints that it needs, relative to
// the blend's own stance footprint. It is what the motion of BlendedMotion measures, but for the
// rounding of its floats.
class Measure {
 public:
  // The library must hold, with one example or more; neither argument is kept.
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
  // `jacobian`: [dimensions x examples], row by row, of the parameters by each weight, or empty.
  // Allocates nothing; several threads may call it, each with a scratch of its own. Codes:
  // parametric-sum where rotations cancel (a sum shorter than 1e-6), parametric-foot where a foot
  // stands upright so that it points nowhere.
  Status operator()(std::span<const double> weights, std::span<double> parameters,
                    std::span<double> jacobian, Scratch& scratch) const;

 private:
  // A joint at a keytime.
  struct Node {
    int keytime = 0;
    int joint = 0;
    int parent = -1;     // index of a node
    bool moves = false;  // whether its place in its parent differs between the examples
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
  double side_ = 1;  // +1 where the swing foot is the left one
  FootShape stance_, swing_;
  std::vector<Parameter> parameters_;
  std::vector<Node> nodes_;    // by keytime; parents before their children
  Eigen::MatrixXd rotations_;  // [examples x (4 * nodes)], x y z w
  Eigen::MatrixXd places_;     // [examples x (3 * nodes)]
  Eigen::VectorXd durations_;  // [examples], seconds
};

}  // namespace krok::parametric
