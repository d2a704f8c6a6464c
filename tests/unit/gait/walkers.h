#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "gait/walk.h"
#include "rbf/weight_solver.h"
#include "samples/generator/rig.h"
#include "unit/parametric/walks.h"

// A library to walk with, footprints, grounds.

namespace krok::gait::test {

// Weights that meet all examples.
inline StepLibrary walking_library(parametric::Library library, std::string name = "walks") {
  std::vector<double> parameters;
  for (const auto& example : library.examples) {
    parameters.insert(parameters.end(), example.parameters.begin(), example.parameters.end());
  }
  const auto solver = rbf::WeightSolver::create(library.dimensions(), parameters);
  EXPECT_TRUE(solver.ok());
  const RoleMap roles = find_roles(library.skeleton);
  auto made = StepLibrary::create(std::move(name), std::move(library), solver->function(), roles);
  EXPECT_TRUE(made.ok()) << made.error().message;
  return *std::move(made);
}

// Steps by length, height and turn of generated walks.
inline StepLibrary walking_library(samples::Rig rig = samples::Rig::hips) {
  std::vector<parametric::test::KeyedWalk> walks = parametric::test::grid_walks(true);
  for (auto& keyed : walks) {
    keyed.walk.clip = samples::with_rig(keyed.walk.clip, rig);
    auto found = find_contacts(keyed.walk.clip, find_roles(keyed.walk.clip.skeleton));
    EXPECT_TRUE(found.ok());
    keyed.found = *std::move(found);
    keyed.keys.contacts = keyed.found.contacts;
  }
  auto library = parametric::test::library_of(walks, {"step.length", "step.height", "step.turn"},
                                              {.mirror = false, .outlier = 0})
                     .library;
  return walking_library(std::move(library));
}

// One library for all tests of a program.
inline std::span<const StepLibrary> walking() {
  static const std::vector<StepLibrary> kLibraries = [] {
    std::vector<StepLibrary> libraries;
    libraries.push_back(walking_library());
    return libraries;
  }();
  return kLibraries;
}

struct Way {
  int steps = 6;
  double length = 0.6, width = 0.1, turn = 0;  // metres, radians a step
  double toe_out = 0;
};
// From standing to standing.
inline std::vector<Print> prints_of(const Way& way) {
  std::vector<Print> prints;
  double x = 0, z = 0, heading = 0;
  const auto put = [&](FootSide side) {
    const double left = side == FootSide::left ? 1 : -1;
    prints.push_back({side,
                      x + left * way.width / 2 * std::cos(heading),
                      z - left * way.width / 2 * std::sin(heading),
                      heading + left * way.toe_out,
                      {},
                      {}});
  };
  put(FootSide::left);
  put(FootSide::right);
  for (int i = 0; i < way.steps; ++i) {
    const double part = i == 0 ? 0.5 : 1;
    heading += part * way.turn;
    x += part * way.length * std::sin(heading);
    z += part * way.length * std::cos(heading);
    put(i % 2 == 0 ? FootSide::left : FootSide::right);
  }
  put(way.steps % 2 == 0 ? FootSide::left : FootSide::right);
  return prints;
}

// Ground of any shape.
class Ground : public Terrain {
 public:
  explicit Ground(std::function<double(double x, double z)> height) : height_(std::move(height)) {}
  std::optional<GroundPoint> at(double x, double z, double below) const override {
    const double height = height_(x, z);
    if (!std::isfinite(height) || height > below) return {};
    constexpr double kNear = 1e-5;
    const Vec3 normal(-(height_(x + kNear, z) - height_(x - kNear, z)) / (2 * kNear), 1,
                      -(height_(x, z + kNear) - height_(x, z - kNear)) / (2 * kNear));
    return GroundPoint{height, normal.normalized()};
  }

 private:
  std::function<double(double, double)> height_;
};
inline Ground slope(double tangent) {
  return Ground([=](double, double z) { return z > 1 ? tangent * (z - 1) : 0.0; });
}
inline Ground rough(double height) {
  return Ground([=](double x, double z) {
    return height / 4 * (std::sin(3.1 * x + 1.3 * z) + std::sin(4.3 * z - 1.7 * x + 1)) *
           std::clamp(z, 0.0, 1.0);
  });
}

}  // namespace krok::gait::test
