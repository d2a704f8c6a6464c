#pragma once

#include <Eigen/Dense>
#include <optional>
#include <span>
#include <vector>

#include "retarget/foot_placement.h"
#include "retarget/moved_limb.h"
#include "retarget/retarget.h"
#include "retarget/touches.h"
#include "scene/frame_source.h"
#include "scene/motion_keys.h"

// Keeps what an actor touches: goals for hands, elbows, knees and feet of the target, and the shift
// of the hips and turn of the trunk with which limbs get there as bent as the source's.

namespace krok::retarget {

// How hips and trunk are moved.
struct BodyShift {
  Vec3 hips = Vec3::Zero();  // metres, world
  Vec3 turn = Vec3::Zero();  // rotation vector of the trunk about its lowest joint, world
};

// Weighted least squares for a BodyShift, from what limbs lack. A limb with its root at `arm` from
// the trunk's pivot that has to move its end by `lack` should do so without more or less bend:
// along the limb the root follows, across it the limb turns.
class ShiftSolver {
 public:
  // `leg` is the target's leg length, metres.
  explicit ShiftSolver(double leg);

  // `across` is the part of the weight with which the root follows across the limb, too.
  // Without `arm` (legs, knees) the trunk's turn does not move the root.
  void add(double weight, const Vec3& along, double across, const Vec3& lack,
           const std::optional<Vec3>& arm);

  // Largest shift 0.35 of the leg, largest turn 20 degrees, in each round.
  BodyShift solve() const;

 private:
  Eigen::Matrix<double, 6, 6> squares_ = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> right_ = Eigen::Matrix<double, 6, 1>::Zero();
  double leg_;
};

// Averages over `reach` frames on either side, with raised-cosine weights.
std::vector<BodyShift> smoothed(const std::vector<BodyShift>& shifts, int reach);

// The touches of the ground of a take.
struct GroundStay {
  Stay stay;
  Vec3 off = Vec3::Zero();  // horizontal, metres: the sum over the frames of where the target's
                            // point is by rotations alone, from the source's, scaled
};
using GroundStays = std::array<std::vector<GroundStay>, kBodyParts>;  // in order, apart

// [2][frames of the take], empty where a foot's stances are unknown.
using StancesOfFeet = std::array<std::span<const KeptStance>, 2>;

// A contact of a foot that stands, kept by LegPlacement.
struct KeptContact {
  std::string part;
  PointPair point;
  Stay stay;        // frames of the take
  double rise = 0;  // of the target's joint above the scaled source's, metres
};

// What one actor's motion touches, and where the target is to touch it, in some frames of a take.
class TouchKeeping {
 public:
  // Finds the touches of the ground. `scale` is lengths of the target over those of the source,
  // `floor` the height of the source's ground, `leg` the length of its legs. The actors stand in
  // their poses.
  TouchKeeping(const Clip& clip, const Actor& source, const Actor& target, double scale,
               double floor, double leg, bool on_ground);

  bool empty() const { return ground_.empty() && on_body_.empty() && !hands_; }

  // Whether a frame is to be noted: for add_stays() and settle(), or `again`, for settle() alone,
  // which takes only the hips from it.
  bool needs(int frame, bool again) const;
  // Keeps where the target's points are by rotations alone. One frame each, on any thread.
  void note(int frame, std::span<const Transform> target_pose);

  // After all needed frames were noted: adds the kept frames of `run`, the clip of which this is,
  // to the stays of the take. The runs come in order.
  void add_stays(const FrameRun& run, GroundStays& stays) const;

  // Where on the ground the target touches it, from the stays of the take. Feet that stand, as
  // `feet` has it, are kept elsewhere. `first` is the number of the clip's first frame.
  void settle(const GroundStays& stays, const StancesOfFeet& feet, int first);

  // Finds the touches of the body. The arguments are those of the constructor.
  void find_on_body(const Clip& clip, const Actor& source, const Actor& target, double leg);

  // What the frame's touches of the ground need of hips and trunk. The pivot of the trunk's turn is
  // pivot().
  void add_lacks(int frame, std::span<const Transform> target_pose, ShiftSolver& solver) const;

  int pivot() const { return pivot_; }

  // Shifts and turns the body, joints above the hips' legs as far as they follow the trunk. Head
  // and hands keep their orientation.
  void turn_trunk(const Vec3& turn, std::span<const Transform> local,
                  std::span<Transform> pose) const;

  // How far a leg kneels, 0 to 1.
  double kneels(int frame, bool is_left) const {
    return weight(is_left ? BodyPart::left_knee : BodyPart::right_knee, frame);
  }

  // Moves knees to their places, before legs are placed; then feet that lie; then arms.
  void place_knees(int frame, std::span<const Transform> local, std::span<Transform> pose) const;
  void place_feet(int frame, std::span<const Transform> local, std::span<Transform> pose) const;
  void place_arms(int frame, std::span<const Transform> source_pose,
                  std::span<const Transform> local, std::span<Transform> pose) const;

  // Every stay, and every contact of `kept`, as far as it is in the kept frames of `run` and the
  // one before, as it is in `result`. Times are those of the take. Heights are over `ground` if it
  // is not null, else those of the world.
  std::vector<ContactReport> report(const FrameRun& run, std::span<const KeptContact> kept,
                                    const Clip& result, const GroundHeight& ground) const;

 private:
  struct OnGround {
    BodyPart part = BodyPart::hips;
    PointPair point;
    Touch touch;
    std::vector<Vec3> place;    // [frames], the source's point, scaled
    std::vector<Vec3> natural;  // [frames], the target's by rotations alone
    std::vector<Vec3> shift;    // [frames], from place to where the target's is to be
  };
  struct OnBody {
    std::size_t side = 0;  // of the hand
    BodyBone bone;
    Touch touch;
  };

  void find_on_ground(const Clip& clip, double floor, double leg);
  const OnGround* on_ground(BodyPart part) const;
  // The goal's way from where the point is, times its weight; zero where it touches nothing.
  Vec3 lack(BodyPart part, int frame, std::span<const Transform> pose) const;
  double weight(BodyPart part, int frame) const;
  // How far a point of the target is above or below where the source's is, scaled, and `rise` more.
  double height_off(const Vec3& from, const Vec3& onto, double rise,
                    const GroundHeight& ground) const;

  std::array<PointPair, kBodyParts> points_;
  double scale_ = 1;
  double leg_ = 0;            // metres, of the source
  std::vector<int> parents_;  // [target joints]
  int pivot_ = -1;
  std::vector<char> turns_with_trunk_;  // [target joints], 1: turns; 2: only moves along
  std::array<std::optional<MovedLimb>, 2> arms_, legs_;
  std::vector<OnGround> ground_;
  std::vector<OnBody> on_body_;
  std::optional<Touch> hands_;  // each other
};

// The contacts of feet that stand by their stances. Heights are those above the actors' floors,
// `heels` what the ankles' contacts are of.
std::vector<KeptContact> kept_contacts(std::span<const Contact> contacts, const Actor& source,
                                       const Actor& target, double scale,
                                       const std::array<Floor, 2>& source_floors,
                                       const Floor& target_floor, double rate,
                                       const StancesOfFeet& feet,
                                       const std::array<std::optional<PointPair>, 2>& heels);

}  // namespace krok::retarget
