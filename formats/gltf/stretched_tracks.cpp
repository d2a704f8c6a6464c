#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "core/index.h"
#include "formats/gltf/joint_tracks.h"
#include "math/dense_solve.h"
#include "math/quaternion.h"

namespace krok::gltf {

namespace {

using Affine = Eigen::Matrix<double, 3, 4>;

constexpr double kShownMove = 1e-6;  // metres
constexpr double kShownScale = 1e-6;
constexpr double kShownTurn = 1e-6;  // radians
// A shear that moves what is a metre from its joint by less than this is rounding: orientations in
// files have errors of up to 1e-4.
constexpr double kShownShear = 1e-4;
constexpr double kShownAxes = 1e-5;  // difference of scales from which their axes are clear

double longest_column(const Mat3& linear) {
  return linear.colwise().norm().maxCoeff();
}

// A joint's transform relative to its parent.
struct LocalAffine {
  Mat3 linear = Mat3::Identity();
  Vec3 place = Vec3::Zero();
  bool known = true;
};

// `before` times what makes it the wanted transform: all of it, or below a flattened parent the
// part that shows. Below one that vanishes nothing does.
LocalAffine local_affine(const Affine& parent, const Mat4& world, const LocalAffine& before) {
  const Mat3 scaled = parent.leftCols<3>(), wanted = world.topLeftCorner<3, 3>();
  const Vec3 offset = world.topRightCorner<3, 1>() - parent.col(3);
  const double size = longest_column(scaled);
  if (std::abs(scaled.determinant()) > 1e-9 * size * size * size) {
    const Mat3 back = scaled.inverse();
    return {back * wanted, back * offset};
  }
  LocalAffine local = before;
  local.known = size > 0;
  if (!local.known) return local;
  for (int c = 0; c < 3; ++c) {
    local.linear.col(c) +=
        solve_minimum_norm(scaled, Vec3(wanted.col(c) - scaled * before.linear.col(c)));
  }
  local.place += solve_minimum_norm(scaled, Vec3(offset - scaled * before.place));
  return local;
}

// Those of frames that are not known from the frame before, or else the next one that is.
void fill_unknown(std::vector<LocalAffine>& locals) {
  const auto first =
      std::ranges::find_if(locals, [](const LocalAffine& local) { return local.known; });
  if (first == locals.end()) return;
  std::fill(locals.begin(), first, *first);
  for (std::size_t f = 1; f < locals.size(); ++f) {
    if (!locals[f].known) locals[f] = locals[f - 1];
  }
}

// One of the 24 orders and signs of the columns of a rotation that is nearest to another one.
Mat3 nearest_order(const Mat3& rotation, const Mat3& wanted) {
  Mat3 best = rotation;
  double most = -4;
  std::array<int, 3> order = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Mat3 turned;
      for (int c = 0; c < 3; ++c) {
        turned.col(c) = rotation.col(order[at(c)]) * ((signs >> c & 1) != 0 ? -1.0 : 1.0);
      }
      const double trace = (wanted.transpose() * turned).trace();
      if (turned.determinant() < 0 || trace <= most) continue;
      most = trace;
      best = turned;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

// A linear part as (turn inner) diag(scales) inner^T, where inner is the identity unless it shears.
struct PolarParts {
  Mat3 turn, stretch;
};

// The polar decomposition; `before` is the rotation where there is none, as for a scale of 0.
PolarParts polar(const Mat3& linear, const Mat3& before) {
  PolarParts parts{before, Mat3::Zero()};
  const double size = linear.norm();
  if (size < 1e-12) return parts;
  // A flattened one has no sign, but for rounding.
  const bool mirrors = linear.determinant() < -1e-9 * size * size * size;
  parts.turn = nearest_rotation(mirrors ? Mat3(-linear) : linear);
  parts.stretch = parts.turn.transpose() * linear;
  return parts;
}

Vec3 in_double(const Vec3f& vector) {
  return vector.cast<double>();
}
Mat3 in_double(const Quatf& rotation) {
  return normalized_or_identity(rotation.cast<double>()).toRotationMatrix();
}

class StretchedTracks {
 public:
  StretchedTracks(const Skeleton& rest, const Clip& clip, std::span<const Stretch> stretches,
                  JointTracks& tracks)
      : rest_(rest),
        clip_(clip),
        stretches_(stretches),
        tracks_(tracks),
        frames_(at(clip.frame_count())),
        shown_(rest.names.size()),
        last_child_(rest.names.size(), -1) {
    for (int j = 0; j < rest.joint_count(); ++j) {
      if (rest.parents[at(j)] >= 0) last_child_[at(rest.parents[at(j)])] = j;
    }
  }

  // Returns the largest error.
  double build() {
    for (int j = 0; j < rest_.joint_count(); ++j) {
      make(j);
      const int parent = rest_.parents[at(j)];
      if (parent >= 0 && last_child_[at(parent)] == j) shown_[at(parent)] = {};
      if (last_child_[at(j)] < 0) shown_[at(j)] = {};
    }
    return largest_error_;
  }

 private:
  Mat4 wanted(std::size_t frame, int joint) const {
    const std::size_t i = frame * rest_.names.size() + at(joint);
    const Transform rigid{clip_.positions[i].cast<double>(),
                          normalized_or_identity(clip_.orientations[i].cast<double>())};
    return joint_to_world(rigid, stretches_[i]);
  }
  // What a viewer computes for the parent.
  Affine parent_of(std::size_t frame, int joint) const {
    const int parent = rest_.parents[at(joint)];
    return parent < 0 ? Affine(Affine::Identity()) : shown_[at(parent)][frame];
  }
  void make(int joint);
  void choose(int joint, const std::vector<PolarParts>& parts, const std::vector<Vec3>& places);
  void show(int joint);

  const Skeleton& rest_;
  const Clip& clip_;
  const std::span<const Stretch> stretches_;
  JointTracks& tracks_;
  const std::size_t frames_;
  std::vector<std::vector<Affine>> shown_;  // joint_to_world, [joints][frames]
  std::vector<int> last_child_;
  double largest_error_ = 0;
};

// The axes of symmetric matrices over time, turning as little as possible: from the matrix with the
// clearest axes on, both ways. Those without axes of their own, all but multiples of the identity,
// take their neighbour's.
std::vector<Mat3> axes_over_time(const std::vector<PolarParts>& parts) {
  std::vector<Mat3> axes(parts.size());
  std::vector<double> clear(parts.size());
  for (std::size_t f = 0; f < parts.size(); ++f) {
    const Mat3 symmetric = 0.5 * (parts[f].stretch + parts[f].stretch.transpose());
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(symmetric);
    axes[f] = solver.eigenvectors();
    clear[f] = solver.eigenvalues()[2] - solver.eigenvalues()[0];
  }
  const auto clearest = static_cast<std::size_t>(std::ranges::max_element(clear) - clear.begin());
  axes[clearest] = nearest_order(axes[clearest], Mat3::Identity());
  const auto follow = [&](std::size_t f, std::size_t from) {
    axes[f] = clear[f] > kShownAxes ? nearest_order(axes[f], axes[from]) : axes[from];
  };
  for (std::size_t f = clearest + 1; f < axes.size(); ++f) follow(f, f - 1);
  for (std::size_t f = clearest; f-- > 0;) follow(f, f + 1);
  return axes;
}

void StretchedTracks::make(int joint) {
  const JointTrack& track = tracks_.joints[at(joint)];
  const Mat3 rest = in_double(track.rest_rotation);
  std::vector<LocalAffine> locals(frames_);
  LocalAffine last{rest, in_double(track.rest_translation)};
  for (std::size_t f = 0; f < frames_; ++f) {
    last = locals[f] = local_affine(parent_of(f, joint), wanted(f, joint), last);
  }
  fill_unknown(locals);
  std::vector<PolarParts> parts;
  std::vector<Vec3> places;
  for (const LocalAffine& local : locals) {
    parts.push_back(polar(local.linear, parts.empty() ? rest : parts.back().turn));
    places.push_back(local.place);
  }
  choose(joint, parts, places);
  show(joint);
}

// Which of the joint's values change, and these.
void StretchedTracks::choose(int joint, const std::vector<PolarParts>& parts,
                             const std::vector<Vec3>& places) {
  JointTrack& track = tracks_.joints[at(joint)];
  const Mat3 rest_turn = in_double(track.rest_rotation);
  bool moves = false, turns = false, scales = false, shears = false;
  for (std::size_t f = 0; f < frames_; ++f) {
    const Mat3 parent = parent_of(f, joint).leftCols<3>();
    const Mat3 aside = parts[f].stretch - Mat3(parts[f].stretch.diagonal().asDiagonal());
    moves = moves || (parent * (places[f] - in_double(track.rest_translation))).norm() > kShownMove;
    turns = turns || angle_between(Quat(parts[f].turn), Quat(rest_turn)) > kShownTurn;
    scales =
        scales || (parts[f].stretch.diagonal() - Vec3::Ones()).cwiseAbs().maxCoeff() > kShownScale;
    shears = shears || longest_column(parent * parts[f].turn * aside) > kShownShear;
  }
  const std::vector<Mat3> axes = shears ? axes_over_time(parts) : std::vector<Mat3>();
  for (std::size_t f = 0; f < frames_; ++f) {
    const Mat3 inner = shears ? axes[f] : Mat3(Mat3::Identity());
    const Vec3 along = (inner.transpose() * parts[f].stretch * inner).diagonal();
    if (shears) track.inner_rotations.push_back(Quat(Mat3(inner.transpose())).cast<float>());
    if (moves) track.translations.push_back(places[f].cast<float>());
    if (turns || shears) {
      track.rotations.push_back(
          normalized_or_identity(Quat(Mat3(parts[f].turn * inner))).cast<float>());
    }
    if (scales || shears) track.scales.push_back(along.cast<float>());
  }
  for (std::vector<Quatf>* rotations : {&track.rotations, &track.inner_rotations}) {
    Quatf before = rotations == &track.rotations ? track.rest_rotation : Quatf::Identity();
    for (Quatf& rotation : *rotations) {
      if (before.dot(rotation) < 0) rotation.coeffs() = -rotation.coeffs();
      before = rotation;
    }
  }
}

// What a viewer computes from the floats.
void StretchedTracks::show(int joint) {
  const JointTrack& track = tracks_.joints[at(joint)];
  std::vector<Affine>& shown = shown_[at(joint)];
  shown.resize(frames_);
  for (std::size_t f = 0; f < frames_; ++f) {
    const Affine parent = parent_of(f, joint);
    Mat3 linear = in_double(track.rotations.empty() ? track.rest_rotation : track.rotations[f]);
    if (!track.scales.empty()) linear = linear * in_double(track.scales[f]).asDiagonal();
    if (!track.inner_rotations.empty()) linear = linear * in_double(track.inner_rotations[f]);
    const Vec3 place =
        in_double(track.translations.empty() ? track.rest_translation : track.translations[f]);
    shown[f].leftCols<3>() = parent.leftCols<3>() * linear;
    shown[f].col(3) = parent.leftCols<3>() * place + parent.col(3);
    const Affine off = shown[f] - wanted(f, joint).topRows<3>();
    largest_error_ = std::max(largest_error_, off.colwise().norm().maxCoeff());
  }
}

}  // namespace

bool JointTracks::are_stretched() const {
  return std::ranges::any_of(joints, [](const JointTrack& joint) { return !joint.scales.empty(); });
}

Result<JointTracks> joint_tracks(const Skeleton& rest, const Clip& clip,
                                 std::span<const Stretch> stretches, double& largest_error) {
  largest_error = 0;
  if (stretches.empty()) return joint_tracks(rest, clip);
  assert(stretches.size() == clip.positions.size());
  auto times = key_times(clip.frame_count(), clip.rate);
  if (!times) return times.error();
  JointTracks tracks = rest_tracks(rest);
  tracks.times = std::move(*times);
  tracks.rate = clip.rate;
  tracks.removed_root_motion = clip.provenance.removed_root_motion;
  largest_error = StretchedTracks(rest, clip, stretches, tracks).build();
  return tracks;
}

}  // namespace krok::gltf
