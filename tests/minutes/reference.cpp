// Frozen: minutes.py measures machines with it. Compiled, it takes templates as the library does;
// run, it multiplies, sorts and hashes.

#include <Eigen/Dense>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace {

double solve(int size, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Eigen::MatrixXd a =
      Eigen::MatrixXd::NullaryExpr(size, size, [&] { return uniform(random); });
  const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(size, [&] { return uniform(random); });
  return (a.transpose() * a + Eigen::MatrixXd::Identity(size, size)).ldlt().solve(b).norm();
}

std::uint64_t count_words(int words, std::mt19937& random) {
  std::map<std::string, int> counts;
  for (int i = 0; i < words; ++i) ++counts["word" + std::to_string(random() % 5000)];
  std::vector<std::pair<int, std::string>> sorted;
  for (const auto& [word, count] : counts) sorted.emplace_back(count, word);
  std::sort(sorted.begin(), sorted.end());
  std::uint64_t hash = 1469598103934665603u;
  for (const auto& [count, word] : sorted)
    hash = (hash ^ std::uint64_t(count) ^ word.size()) * 1099511628211u;
  return hash;
}

}  // namespace

int main() {
  std::mt19937 random(1);
  double sum = 0;
  std::uint64_t hash = 0;
  for (int round = 0; round < 40; ++round) {
    sum += solve(200, random);
    hash ^= count_words(100000, random);
  }
  std::printf("%.6f %llu\n", sum, static_cast<unsigned long long>(hash));
}
