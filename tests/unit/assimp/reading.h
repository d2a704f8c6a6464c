#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "formats/assimp/assimp_reader.h"
#include "nodes/evaluate.h"

namespace krok::test {

// A folder of its own, removed at the end.
class Folder {
 public:
  Folder() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() /
            (std::string("krok-assimp-") + std::to_string(getpid()) + "-" + info->name());
    std::filesystem::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  std::string add(const std::string& name, const std::string& content) const {
    const std::filesystem::path path = path_ / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << content;
    return path.string();
  }

 private:
  std::filesystem::path path_;
};

inline nodes::Scene read_or_fail(const std::string& path) {
  auto scene = assimp::read_file(path);
  EXPECT_TRUE(scene.ok()) << scene.error().code << ": " << scene.error().message;
  return scene ? std::move(*scene) : nodes::Scene();
}

inline int node_named(const nodes::Scene& scene, const std::string& name) {
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    if (scene.nodes[n].name == name) return static_cast<int>(n);
  }
  ADD_FAILURE() << "no node " << name;
  return 0;
}

inline nodes::Evaluation evaluate(const nodes::Scene& scene, int animation, double time) {
  nodes::Evaluation state;
  const auto evaluator = nodes::Evaluator::create(scene);
  EXPECT_TRUE(evaluator.ok());
  if (evaluator) evaluator->evaluate(animation, time, state);
  return state;
}

inline Mat4 node_to_world(const nodes::Scene& scene, const std::string& name, int animation,
                          double time) {
  const int node = node_named(scene, name);
  return evaluate(scene, animation, time).node_to_world[static_cast<std::size_t>(node)];
}

// What Assimp does at the root of formats with +Z up.
inline Mat4 z_up_to_y_up() {
  Mat4 m = Mat4::Zero();
  m(0, 0) = m(1, 2) = m(3, 3) = 1;
  m(2, 1) = -1;
  return m;
}

inline bool has_code(const Diagnostics& diagnostics, const std::string& code) {
  for (const Diagnostic& diagnostic : diagnostics) {
    if (diagnostic.code == code) return true;
  }
  return false;
}

inline void expect_near(const Mat4& actual, const Mat4& expected, double tolerance,
                        const std::string& what) {
  EXPECT_LT((actual - expected).cwiseAbs().maxCoeff(), tolerance) << what << "\nactual\n"
                                                                  << actual << "\nexpected\n"
                                                                  << expected;
}

}  // namespace krok::test
