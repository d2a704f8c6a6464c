#pragma once

#include <Eigen/Geometry>
#include <map>
#include <string>
#include <vector>

// Forward kinematics of ASF/AMC and BVH written for the tests alone: rotation matrices, recursion,
// streams and maps, nothing of the library. Takes whole, well-formed files of the CMU collection.

namespace naive {

using Positions = std::map<std::string, Eigen::Vector3d>;

struct AcclaimBone {
  std::string name;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  double length = 0;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  std::vector<std::string> dof;
  std::vector<std::string> children;
};

class Acclaim {
 public:
  Acclaim(const std::string& asf, const std::string& amc);
  std::size_t frame_count() const { return frames_.size(); }
  // Where bones begin, and where all end under "<bone> end", in the file's unit and axes.
  Positions frame(std::size_t index) const;
  Positions reference() const;

 private:
  using Values = std::map<std::string, std::vector<double>>;
  void place(const std::string& name, const Eigen::Matrix3d& parent, const Eigen::Vector3d& begin,
             const Values& values, Positions& positions) const;
  std::map<std::string, AcclaimBone> bones_;
  std::vector<Values> frames_;
};

class Bvh {
 public:
  explicit Bvh(const std::string& text);
  std::size_t frame_count() const { return frames_.size(); }
  // Positions of joints, and in `rotations` their orientations, in the file's unit and axes.
  Positions frame(std::size_t index, std::map<std::string, Eigen::Matrix3d>* rotations) const;

 private:
  struct Joint {
    std::string name;
    int parent;
    Eigen::Vector3d offset;
    std::vector<std::string> channels;
  };
  std::vector<Joint> joints_;
  std::vector<std::vector<double>> frames_;
};

}  // namespace naive
