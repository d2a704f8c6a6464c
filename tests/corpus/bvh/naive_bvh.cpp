#include "corpus/bvh/naive_bvh.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace naive {

namespace {

using Matrix = std::array<std::array<double, 4>, 4>;

Matrix identity() {
  Matrix m{};
  for (std::size_t i = 0; i < 4; ++i) m[i][i] = 1;
  return m;
}

Matrix times(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      for (std::size_t k = 0; k < 4; ++k) c[i][j] += a[i][k] * b[k][j];
    }
  }
  return c;
}

Matrix rotation(char axis, double degrees) {
  const double a = degrees * 3.14159265358979323846 / 180.0;
  const double c = std::cos(a);
  const double s = std::sin(a);
  Matrix m = identity();
  if (axis == 'X') {
    m[1][1] = c, m[1][2] = -s, m[2][1] = s, m[2][2] = c;
  } else if (axis == 'Y') {
    m[0][0] = c, m[0][2] = s, m[2][0] = -s, m[2][2] = c;
  } else {
    m[0][0] = c, m[0][1] = -s, m[1][0] = s, m[1][1] = c;
  }
  return m;
}

std::string next(std::istringstream& in) {
  std::string word;
  if (!(in >> word)) throw std::runtime_error("the file ends");
  return word;
}

}  // namespace

Bvh parse(const std::string& text) {
  Bvh bvh;
  std::istringstream in(text);
  std::vector<int> open;
  if (next(in) != "HIERARCHY") throw std::runtime_error("no HIERARCHY");
  for (std::string word = next(in); word != "MOTION"; word = next(in)) {
    if (word == "ROOT" || word == "JOINT" || word == "End") {
      Bvh::Joint joint;
      joint.parent = open.empty() ? -1 : open.back();
      std::string name;
      for (std::string part = next(in); part != "{"; part = next(in)) {
        name += (name.empty() ? "" : " ") + part;
      }
      if (word != "End") joint.name = name;
      open.push_back(static_cast<int>(bvh.joints.size()));
      bvh.joints.push_back(joint);
    } else if (word == "OFFSET") {
      for (double& component : bvh.joints[static_cast<std::size_t>(open.back())].offset) {
        component = std::stod(next(in));
      }
    } else if (word == "CHANNELS") {
      const int count = std::stoi(next(in));
      for (int i = 0; i < count; ++i) {
        bvh.joints[static_cast<std::size_t>(open.back())].channels.push_back(next(in));
      }
    } else if (word == "}") {
      open.pop_back();
    } else {
      throw std::runtime_error("unexpected " + word);
    }
  }
  if (next(in) != "Frames:") throw std::runtime_error("no Frames:");
  bvh.announced = std::stoi(next(in));
  if (next(in) != "Frame" || next(in) != "Time:") throw std::runtime_error("no Frame Time:");
  bvh.frame_time = std::stod(next(in));
  std::size_t channels = 0;
  for (const auto& joint : bvh.joints) channels += joint.channels.size();
  std::vector<double> row;
  std::string word;
  while (in >> word) {
    row.push_back(std::stod(word));
    if (row.size() == channels) {
      bvh.rows.push_back(row);
      row.clear();
    }
  }
  return bvh;
}

std::vector<Point> world_positions(const Bvh& bvh, const std::vector<double>& row, bool additive) {
  std::vector<Matrix> world(bvh.joints.size());
  std::vector<Point> positions;
  std::size_t value = 0;
  for (std::size_t j = 0; j < bvh.joints.size(); ++j) {
    const Bvh::Joint& joint = bvh.joints[j];
    Matrix translation = identity();
    for (std::size_t i = 0; i < 3; ++i) translation[i][3] = joint.offset[i];
    Matrix turn = identity();
    for (const std::string& channel : joint.channels) {
      const double v = row[value++];
      const auto axis = static_cast<std::size_t>(channel[0] - 'X');
      if (channel.find("position") != std::string::npos) {
        translation[axis][3] = additive ? joint.offset[axis] + v : v;
      } else {
        turn = times(turn, rotation(channel[0], v));
      }
    }
    world[j] = times(translation, turn);
    if (joint.parent >= 0)
      world[j] = times(world[static_cast<std::size_t>(joint.parent)], world[j]);
    positions.push_back({world[j][0][3], world[j][1][3], world[j][2][3]});
  }
  return positions;
}

}  // namespace naive
