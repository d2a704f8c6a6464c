#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/index.h"
#include "motion/hips_root.h"
#include "motion/local_motion.h"
#include "ragdoll/bodies.h"
#include "retarget/touches.h"
#include "scene/frame_source.h"
#include "settle/settle.h"
#include "terrain/terrain.h"

namespace krok::settling {

// Least squares for a step of values over time, [frames][size], whose second differences count as
// errors, too: normal equations of a block for each frame, tied to the two frames before.
class SmoothSystem {
 public:
  SmoothSystem(int frames, Eigen::Index size);

  // The equations of a frame, to which errors of its own are added: J^T J and J^T error.
  Eigen::MatrixXd& matrix(int frame) { return matrix_[static_cast<std::size_t>(frame)]; }
  Eigen::VectorXd& right(int frame) { return right_[static_cast<std::size_t>(frame)]; }

  void clear();

  // The step of each frame, [frames], from `values` [before + frames], of which the first `before`
  // (0 to 2) stay. `bend` is the weight of squared second differences, [size]. Solved by a block
  // Cholesky decomposition in time linear in the frames. Equations of frames must leave nothing
  // open.
  const std::vector<Eigen::VectorXd>& solve(std::span<const Eigen::VectorXd> values, int before,
                                            const Eigen::VectorXd& bend);

 private:
  std::vector<Eigen::MatrixXd> matrix_, one_before_, two_before_;
  std::vector<Eigen::VectorXd> right_;
  Eigen::Index size_;
};

// What of a body can touch the ground, as small spheres.

struct SupportPoint {
  int body = 0;
  Vec3 centre = Vec3::Zero();  // metres, in the frame of the body's joint
  double radius = 0;
};

// Of each body, in order: along capsules and over the sides of boxes; with a model its vertices
// that are outermost in 80 directions.
std::vector<SupportPoint> support_points(const std::vector<ragdoll::Body>& bodies,
                                         const Model* model);

// The ground at a place (world): the highest surface up to a step above it, or else the highest.
std::optional<GroundPoint> surface_at(const Terrain& ground, const Vec3& place);

// How far a sphere (world) is above the ground, metres, negative if it is in it; infinite where
// there is no ground.
double clearance(const Terrain& ground, const Vec3& centre, double radius);

// The ground as a ball (a paraboloid) of 1.5 m radius rolls over it: what lies across stairs rests
// on a ramp over the edges of the steps (morphological closing). Nowhere below the ground.
class RolledGround final : public Terrain {
 public:
  // Over a rectangle on the ground (x, z); beyond it the ground is as it is. `ground` must outlive
  // this.
  RolledGround(const Terrain& ground, const Vec2& low, const Vec2& high, int jobs = 0);

  // Whether there are steps: heights that differ by more than 1.25 of the way from one place to the
  // next (51 degrees).
  bool has_steps() const { return has_steps_; }

  std::optional<GroundPoint> at(double x, double z, double below) const override;

 private:
  void find_heights(const Vec2& extent, double size);
  void spread(std::span<const float> below, float sign);
  float cell(int column, int row) const {
    return heights_[static_cast<std::size_t>(row * columns_ + column)];
  }
  double height(double column, double row) const;  // NaN where there is none

  const Terrain& ground_;
  int jobs_;
  Vec2 low_;
  double size_ = 0;  // of a cell, metres
  int columns_ = 0, rows_ = 0;
  std::vector<float> heights_;  // [rows x columns], NaN where there is no ground
  bool has_steps_ = false;
};

// The steps of settle(): what touches (find_ground.cpp), where it belongs (support_points.cpp), and
// the smoothest motion that brings it there (solve.cpp).

inline constexpr double kTolerated = 0.005;  // metres
// Of a person of 1.75 m, metres: parts touch below the one, and are free above the other.
inline constexpr double kNear = 0.01, kFar = 0.3;

using Stays = std::vector<std::vector<retarget::Stay>>;  // [bodies]

// The places of parts in each frame over a ground, and when they touch it.
struct Heights {
  std::vector<double> of_bodies;  // [bodies x frames], of the lowest point
  Stays stays;
};

// What a point is to do in a frame.
struct Target {
  double weight = 0;
  double rise = 0;                // metres, from where it is in the source
  double push = 0;                // metres, what it lacked so far
  std::optional<double> pressed;  // the rise that brings it on the ground, and beyond by `push`
  Vec3 place = Vec3::Zero();      // in the source, world
  Vec3 slope = Vec3::Zero();      // of the ground there: rise over way along x and z
};

// A joint that may turn.
struct Freedom {
  int joint = 0;
  Mat3 damping = Mat3::Identity();
  std::optional<Vec3> hinge;  // in the parent's frame; bends by positive turns
  int bone_from = -1, bone_to = -1;
};

// Gaps (NaN) take the value before them, and those at the start the first one; 0 if there is none.
void fill_gaps(std::span<double> values);

class Settler {
 public:
  Settler(FrameSource frames, HipsRoot hips_root, const RoleMap& roles, const Terrain& ground,
          const SettleOptions& options, std::vector<ragdoll::Body> bodies, const Skeleton& neutral);

  Status find_ground();
  void find_freedoms();
  void solve();
  void keep_source() { values_.clear(); }  // finish() then gives the motion as it was
  // The frames of the result keep `self`, which is this.
  Result<Settled> finish(const std::shared_ptr<const Settler>& self);
  bool lies_already() const { return lies_already_; }

 private:
  // The height of a point, at a place in a frame, over what counts as the ground.
  using Over = std::function<double(const SupportPoint& point, const Vec3& place, int frame)>;
  using Values = std::vector<Eigen::VectorXd>;  // [frames]: shift of the hips, turns of freedoms

  int frames() const { return frames_.frame_count; }
  std::size_t size() const { return 3 + 3 * freedoms_.size(); }

  // Passes the frames of a rooted motion in blocks: the number of the first, and their transforms.
  void each(const FrameSource& rooted,
            const std::function<void(int first, LocalMotion& block)>& use) const;
  // `over` gives the height of a sphere over what counts as the ground.
  Heights heights(const FrameSource& rooted, const Over& over) const;
  Heights over_ground(const FrameSource& rooted) const;
  double usual(const Heights& heights) const;
  GroundFit fit(const Heights& on_ground, const Heights& over_rest, const Stays& touches) const;
  double upright(std::span<const Transform> pose) const;
  // Over what a part rests on: steps are a ramp, but for the feet of who is upright.
  double over_rest(const SupportPoint& point, const Vec3& place, int frame) const;
  Vec3 slope_under(const SupportPoint& point, const Vec3& place, int frame) const;
  void find_steps();
  void find_treads();
  std::vector<double> common_lift(const Heights& source) const;
  void set_goals(Heights source);
  std::vector<Transform> pose_of(const LocalMotion& motion, int frame) const;
  // Frames of the source from `first` on become those of the result.
  void move(int first, LocalMotion& block) const;
  std::vector<Transform> moved_pose(int frame) const;
  bool touches(std::size_t body, std::size_t frame) const {
    const auto& stays = over_source_.stays[body];
    const auto after =
        std::ranges::upper_bound(stays, static_cast<int>(frame), {}, &retarget::Stay::first);
    return after != stays.begin() && static_cast<int>(frame) <= std::prev(after)->last;
  }
  // For the frames of a stretch, which become stretch_.
  void set_targets(int first, int last);
  // Both return half the sum of the squared errors.
  double add_goals(int frame, std::span<const Transform> pose, Eigen::MatrixXd& matrix,
                   Eigen::VectorXd& right) const;
  double add_damping(int frame, std::span<const Transform> pose, Eigen::MatrixXd& matrix,
                     Eigen::VectorXd& right) const;
  double add_frames(int first, int last, const Eigen::VectorXd& bend, SmoothSystem& system) const;
  double bend_of(const Freedom& freedom, std::span<const Transform> pose) const;
  // `loose`: how strongly the change may bend at first, of the strongest.
  void solve_stretch(int first, int last, double loose);
  double correct_targets(int first, int last);
  // The 99th percentile of sums of the parts' places in four frames times `factors`, metres: of the
  // source, or as it is moved.
  double differences(bool moved, const Eigen::Vector4d& factors) const;

  FrameSource frames_;
  const RoleMap& roles_;
  const Terrain& ground_;
  const SettleOptions& options_;
  std::vector<ragdoll::Body> bodies_;
  std::vector<SupportPoint> points_;
  std::vector<std::pair<std::size_t, std::size_t>> points_of_;  // [bodies], begin and end
  HipsRoot hips_root_;
  FrameSource rooted_;
  std::vector<int> parents_;
  mutable Status status_;  // the first error of the source
  double scale_ = 1;       // of a person of 1.75 m

  std::unique_ptr<RolledGround> rolled_;  // where there are steps
  std::vector<double> on_tread_;  // [bodies x frames], 1: on a tread, 0: on the ramp over steps
  std::vector<double> treads_;    // [bodies x frames], heights; empty: what is under each point
  double floor_ = 0;
  bool follows_ground_ = false, lies_already_ = false;
  int without_ground_ = 0;            // frames
  std::vector<double> lift_;          // [frames]
  std::vector<double> ground_below_;  // [frames], above the floor, and the lift: of the hips
  Heights over_source_;
  std::vector<double> raised_;  // [bodies x frames], by how much parts should be higher
  GroundFit fit_;               // of the source on the ground

  std::vector<Freedom> freedoms_;
  std::vector<std::vector<std::size_t>> chains_;  // [bodies], of freedoms
  Values values_;
  // Of the frames that are solved together:
  int stretch_first_ = 0;
  LocalMotion stretch_;          // of the source
  std::vector<Target> targets_;  // [frames x points]
  Values near_;                  // as the pass before has left them; empty before the first
};

}  // namespace krok::settling
