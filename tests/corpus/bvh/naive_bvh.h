#pragma once

#include <array>
#include <string>
#include <vector>

// A second opinion on BVH: a parser that splits at white space, and forward kinematics with plain
// 4x4 matrices, written without any of the project's own code.

namespace naive {

using Point = std::array<double, 3>;

struct Bvh {
  struct Joint {
    std::string name;  // empty for End Sites
    int parent = -1;
    Point offset{};
    std::vector<std::string> channels;
  };
  std::vector<Joint> joints;  // in the file's order
  std::vector<std::vector<double>> rows;
  double frame_time = 0;
  int announced = 0;
};

Bvh parse(const std::string& text);

// World positions of all joints, with position channels replacing OFFSETs or added to them.
std::vector<Point> world_positions(const Bvh& bvh, const std::vector<double>& row, bool additive);

}  // namespace naive
