#include "parametric/style_groups.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "contacts/legs.h"
#include "core/index.h"
#include "math/dense_solve.h"
#include "parametric/bounds.h"
#include "parametric/leave_one_out.h"
#include "roles/roles.h"

namespace krok::parametric {

namespace {

constexpr int kMaxGroups = 20;
constexpr int kMaxCaptures = 1000;
constexpr int kGroupingRounds = 3;
constexpr std::size_t kSampleStride = 4;  // of the samples of an example

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Joints that carry others, without fingers, as places among those of example_poses().
std::vector<std::size_t> body_of(const Library& library) {
  const PackedExamples packed = pack_examples(library.with({library.examples.front()}));
  const Skeleton& skeleton = packed.skeleton;
  const RoleMap roles = find_roles(skeleton);
  const auto in_hand = [&](int joint) {
    return std::ranges::any_of(std::array{Role::left_hand, Role::right_hand}, [&](Role hand) {
      return roles.joint(hand) >= 0 && is_below(skeleton, joint, roles.joint(hand));
    });
  };
  std::vector<std::size_t> body;
  std::size_t place = 0;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (packed.hips_root.below()[at(j)] == 0) continue;
    const bool carries = std::ranges::find(skeleton.parents, j) != skeleton.parents.end();
    if (carries && !in_hand(j)) body.push_back(place);
    ++place;
  }
  return body;
}

// [examples x coordinates] relative to the stance foot's print.
Rows poses_of(const Library& library) {
  const std::vector<std::size_t> body = body_of(library);
  Rows poses;
  for (std::size_t i = 0; i < library.examples.size(); ++i) {
    const std::vector<Vec3> all = detail::example_poses(library, i);
    const std::size_t samples = detail::samples_of(library), joints = all.size() / samples;
    if (i == 0) {
      poses.resize(static_cast<Eigen::Index>(library.examples.size()),
                   static_cast<Eigen::Index>(3 * body.size() * (samples / kSampleStride)));
    }
    Eigen::Index column = 0;
    for (std::size_t k = 0; k < samples; k += kSampleStride) {
      for (const std::size_t joint : body) {
        poses.row(static_cast<Eigen::Index>(i)).segment<3>(column) = all[k * joints + joint];
        column += 3;
      }
    }
  }
  return poses;
}

// The means of rows by group, [groups x columns].
Rows means_by(const Rows& rows, std::span<const int> groups, int count) {
  Rows means = Rows::Zero(count, rows.cols());
  Eigen::VectorXd members = Eigen::VectorXd::Zero(count);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    means.row(groups[at(i)]) += rows.row(i);
    members[groups[at(i)]] += 1;
  }
  return members.cwiseMax(1).cwiseInverse().asDiagonal() * means;
}

// Without what changes with the parameters inside the groups.
Rows without_parameters(const Rows& poses, const Rows& parameters, std::span<const int> groups,
                        int count) {
  const Rows pose_means = means_by(poses, groups, count);
  const Rows parameter_means = means_by(parameters, groups, count);
  Rows from_means = parameters, poses_from_means = poses;
  for (Eigen::Index i = 0; i < poses.rows(); ++i) {
    from_means.row(i) -= parameter_means.row(groups[at(i)]);
    poses_from_means.row(i) -= pose_means.row(groups[at(i)]);
  }
  // Parameters are scaled to 0 to 1: the ridge is for those that are the same inside each group.
  Eigen::MatrixXd normal = from_means.transpose() * from_means;
  normal.diagonal().array() += 1e-6 * static_cast<double>(poses.rows());
  const Eigen::MatrixXd slopes = solve_square(normal, from_means.transpose() * poses_from_means);
  return poses - parameters * slopes;
}

// Metres, of joints.
double spread_within(const Rows& poses, std::span<const int> groups, int count) {
  const Rows means = means_by(poses, groups, count);
  double sum = 0;
  for (Eigen::Index i = 0; i < poses.rows(); ++i) {
    sum += (poses.row(i) - means.row(groups[at(i)])).squaredNorm();
  }
  return std::sqrt(3 * sum / static_cast<double>(poses.size()));
}

// Joins the two captures or groups that raise the spread least, one after the other. Returns for
// each join its two captures, the lower one standing for both from then on.
std::vector<std::pair<int, int>> joins_of(const Rows& means) {
  const int n = static_cast<int>(means.rows());
  const Eigen::VectorXd norms = means.rowwise().squaredNorm();
  Eigen::MatrixXd apart = -2 * means * means.transpose();
  apart.colwise() += norms;
  apart.rowwise() += norms.transpose();
  std::vector<int> alive(at(n));
  std::iota(alive.begin(), alive.end(), 0);
  std::vector<double> size(at(n), 1);
  std::vector<std::pair<int, int>> joins;
  while (alive.size() > 1) {
    double least = std::numeric_limits<double>::infinity();
    std::pair<int, int> next;
    for (std::size_t k = 0; k < alive.size(); ++k) {
      for (std::size_t m = k + 1; m < alive.size(); ++m) {
        if (apart(alive[m], alive[k]) >= least) continue;
        least = apart(alive[m], alive[k]);
        next = {alive[k], alive[m]};
      }
    }
    const auto [a, b] = next;
    // Lance and Williams, Computer J. 9, 1967.
    for (const int other : alive) {
      if (other == a || other == b) continue;
      const double all = size[at(a)] + size[at(b)] + size[at(other)];
      apart(a, other) = apart(other, a) =
          ((size[at(a)] + size[at(other)]) * apart(other, a) +
           (size[at(b)] + size[at(other)]) * apart(other, b) - size[at(other)] * least) /
          all;
    }
    size[at(a)] += size[at(b)];
    std::erase(alive, b);
    joins.push_back(next);
  }
  return joins;
}

// [captures] the group of each when so many are left.
std::vector<int> groups_after(const std::vector<std::pair<int, int>>& joins, int captures,
                              int count) {
  std::vector<int> lead(at(captures));
  std::iota(lead.begin(), lead.end(), 0);
  for (int k = 0; k < captures - count; ++k) {
    std::ranges::replace(lead, joins[at(k)].second, joins[at(k)].first);
  }
  std::vector<int> numbers(at(captures), -1), groups;
  int next = 0;
  for (const int one : lead) {
    if (numbers[at(one)] < 0) numbers[at(one)] = next++;
    groups.push_back(numbers[at(one)]);
  }
  return groups;
}

void regroup(const Rows& poses, std::span<const int> captures, int count, StyleGroups& styles) {
  const auto joins = joins_of(means_by(poses, captures, count));
  const int most = std::min(kMaxGroups, count);
  for (styles.count = 1;; ++styles.count) {
    const std::vector<int> groups = groups_after(joins, count, styles.count);
    std::ranges::transform(captures, styles.of_example.begin(),
                           [&](int capture) { return groups[at(capture)]; });
    styles.within = spread_within(poses, styles.of_example, styles.count);
    if (styles.within <= kAlikeSteps || styles.count == most) return;
  }
}

}  // namespace

Result<StyleGroups> group_styles(const Library& library, std::span<const int> captures) {
  if (Status status = check(library); !status) return status.error();
  const std::size_t n = library.examples.size();
  if (captures.size() != n || std::ranges::any_of(captures, [](int c) { return c < 0; })) {
    return Error("parametric-groups", "each example needs a capture, counted from 0");
  }
  StyleGroups styles;
  styles.of_example.assign(n, 0);
  if (n == 0) return styles;
  const Rows poses = poses_of(library);
  // Limbs of one side are not those of the other: mirrored steps differ.
  const Bounds bounds = bounds_of(library);
  Rows parameters(poses.rows(), bounds.dimensions + 1);
  parameters.leftCols(bounds.dimensions) =
      Eigen::Map<const Rows>(bounds.points.data(), poses.rows(), bounds.dimensions);
  for (std::size_t i = 0; i < n; ++i) {
    parameters(static_cast<Eigen::Index>(i), bounds.dimensions) =
        library.examples[i].mirrored ? 1 : 0;
  }
  const Rows plain = without_parameters(poses, parameters, styles.of_example, 1);
  styles.spread = styles.within = spread_within(plain, styles.of_example, 1);
  const int count = 1 + std::ranges::max(captures);
  if (count < 2 || count > kMaxCaptures || styles.spread <= kAlikeSteps) return styles;
  for (int round = 0; round < kGroupingRounds; ++round) {
    const int groups = styles.count;
    regroup(without_parameters(poses, parameters, styles.of_example, groups), captures, count,
            styles);
  }
  return styles;
}

}  // namespace krok::parametric
