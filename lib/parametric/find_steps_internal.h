#pragma once

#include <string>
#include <vector>

#include "parametric/cut_steps.h"

// Where the steps of a walk begin and end. Used by cut_steps().

namespace krok::parametric {

struct Strike {
  FootSide side;
  double time;  // seconds
};
std::vector<Strike> strikes_of(const MotionKeys& keys);

struct FoundStep {
  FootSide swing = FootSide::left;
  std::vector<double> times;  // seconds, of keytimes_of() the gait
  std::string fault;          // why it is not a valid step; empty if it is
};

// `carrier`: the joint that carries the motion, see carrying_joint().
std::vector<FoundStep> find_steps(const Clip& clip, int carrier, const MotionKeys& keys,
                                  const CutOptions& options);

}  // namespace krok::parametric
