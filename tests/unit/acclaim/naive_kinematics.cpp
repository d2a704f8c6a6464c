#include "unit/acclaim/naive_kinematics.h"

#include <cctype>
#include <cmath>
#include <sstream>

namespace naive {

namespace {

Eigen::Matrix3d turn(char axis, double degrees) {
  const double a = degrees * 3.14159265358979323846 / 180.0;
  const double c = std::cos(a), s = std::sin(a);
  Eigen::Matrix3d m;
  if (axis == 'x') {
    m << 1, 0, 0, 0, c, -s, 0, s, c;
  } else if (axis == 'y') {
    m << c, 0, s, 0, 1, 0, -s, 0, c;
  } else {
    m << c, -s, 0, s, c, 0, 0, 0, 1;
  }
  return m;
}

}  // namespace

Acclaim::Acclaim(const std::string& asf, const std::string& amc) {
  std::istringstream lines(asf);
  std::string line, section;
  AcclaimBone bone;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string key;
    if (!(words >> key)) continue;
    if (key[0] == ':') section = key;
    if (section == ":bonedata") {
      if (key == "begin") bone = AcclaimBone();
      if (key == "name") words >> bone.name;
      if (key == "direction") {
        words >> bone.direction.x() >> bone.direction.y() >> bone.direction.z();
      }
      if (key == "length") words >> bone.length;
      if (key == "axis") {
        double x = 0, y = 0, z = 0;
        words >> x >> y >> z;
        bone.axes = turn('z', z) * turn('y', y) * turn('x', x);
      }
      std::string dof;
      if (key == "dof") {
        while (words >> dof) bone.dof.push_back(dof);
      }
      if (key == "end") bones_[bone.name] = bone;
    } else if (section == ":hierarchy" && key != "begin" && key != "end") {
      std::string child;
      while (words >> child) bones_[key].children.push_back(child);
    }
  }
  std::istringstream motion(amc);
  while (std::getline(motion, line)) {
    std::istringstream words(line);
    std::string key;
    if (!(words >> key) || key[0] == '#' || key[0] == ':') continue;
    if (std::isdigit(static_cast<unsigned char>(key[0])) != 0) {
      frames_.emplace_back();
      continue;
    }
    double value = 0;
    while (words >> value) frames_.back()[key].push_back(value);
  }
}

void Acclaim::place(const std::string& name, const Eigen::Matrix3d& parent,
                    const Eigen::Vector3d& begin, const Values& values,
                    Positions& positions) const {
  const AcclaimBone& bone = bones_.at(name);
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  const auto found = values.find(name);
  for (std::size_t i = 0; found != values.end() && i < bone.dof.size(); ++i) {
    rotation = turn(bone.dof[i][1], found->second[i]) * rotation;
  }
  const Eigen::Matrix3d world = parent * (bone.axes * rotation * bone.axes.transpose());
  const Eigen::Vector3d end = begin + world * (bone.length * bone.direction);
  positions[name] = begin;
  positions[name + " end"] = end;
  for (const std::string& child : bone.children) place(child, world, end, values, positions);
}

Positions Acclaim::frame(std::size_t index) const {
  const Values& values = frames_.at(index);
  const std::vector<double>& root = values.at("root");
  const Eigen::Vector3d position(root[0], root[1], root[2]);
  const Eigen::Matrix3d rotation = turn('z', root[5]) * turn('y', root[4]) * turn('x', root[3]);
  Positions positions;
  positions["root"] = position;
  for (const std::string& child : bones_.at("root").children) {
    place(child, rotation, position, values, positions);
  }
  return positions;
}

Positions Acclaim::reference() const {
  Positions positions;
  positions["root"] = Eigen::Vector3d::Zero();
  for (const std::string& child : bones_.at("root").children) {
    place(child, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero(), {}, positions);
  }
  return positions;
}

Bvh::Bvh(const std::string& text) {
  std::istringstream words(text);
  std::string word;
  std::vector<int> open;
  while (words >> word && word != "MOTION") {
    if (word == "ROOT" || word == "JOINT" || word == "End") {
      Joint joint;
      words >> joint.name;
      if (word == "End") joint.name = joints_.back().name + " end";
      joint.parent = open.empty() ? -1 : open.back();
      open.push_back(static_cast<int>(joints_.size()));
      joints_.push_back(joint);
    } else if (word == "OFFSET") {
      Eigen::Vector3d& offset = joints_[static_cast<std::size_t>(open.back())].offset;
      words >> offset.x() >> offset.y() >> offset.z();
    } else if (word == "CHANNELS") {
      std::size_t count = 0;
      words >> count;
      auto& channels = joints_[static_cast<std::size_t>(open.back())].channels;
      channels.resize(count);
      for (std::string& channel : channels) words >> channel;
    } else if (word == "}") {
      open.pop_back();
    }
  }
  std::size_t frames = 0;
  words >> word >> frames >> word >> word >> word;
  std::size_t channels = 0;
  for (const Joint& joint : joints_) channels += joint.channels.size();
  frames_.assign(frames, std::vector<double>(channels));
  for (auto& frame : frames_) {
    for (double& value : frame) words >> value;
  }
}

Positions Bvh::frame(std::size_t index, std::map<std::string, Eigen::Matrix3d>* rotations) const {
  const std::vector<double>& values = frames_.at(index);
  std::vector<Eigen::Matrix3d> world(joints_.size());
  std::vector<Eigen::Vector3d> position(joints_.size());
  Positions positions;
  std::size_t next = 0;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Joint& joint = joints_[j];
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    Eigen::Vector3d offset = joint.offset;
    for (const std::string& channel : joint.channels) {
      const double value = values[next++];
      const char axis = static_cast<char>(std::tolower(static_cast<unsigned char>(channel[0])));
      if (channel.substr(1) == "position") {
        offset[axis - 'x'] += value;
      } else {
        rotation = rotation * turn(axis, value);
      }
    }
    if (joint.parent < 0) {
      world[j] = rotation;
      position[j] = offset;
    } else {
      const auto p = static_cast<std::size_t>(joint.parent);
      world[j] = world[p] * rotation;
      position[j] = position[p] + world[p] * offset;
    }
    positions[joint.name] = position[j];
    if (rotations != nullptr) (*rotations)[joint.name] = world[j];
  }
  return positions;
}

}  // namespace naive
