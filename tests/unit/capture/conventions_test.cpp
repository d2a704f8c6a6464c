// If these fail, captures arrive too large, lying on their back or facing sideways.
#include "capture/conventions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "math/quaternion.h"

namespace krok {
namespace {

// A person of 1.7 m, hips at the origin, feet `spread` apart, written in a unit and in axes.
Skeleton person(double metres_per_unit, Direction up, Direction forward) {
  const Mat3 to_file = rotation_to_krok(up, forward)->conjugate().toRotationMatrix();
  Skeleton s;
  const auto add = [&](const char* name, int parent, double x, double y, double z) {
    return s.add(name, parent, {to_file * Vec3(x, y, z) / metres_per_unit, Quat::Identity()});
  };
  const int hips = add("Hips", -1, 0, 0, 0);
  const int spine = add("Spine", hips, 0, 0.4, 0);
  const int neck = add("Neck", spine, 0, 0.5, 0);
  add("Head", neck, 0, 0.62, 0);
  for (const double side : {1.0, -1.0}) {
    const std::string lr = side > 0 ? "Left" : "Right";
    const int shoulder = add((lr + "Shoulder").c_str(), spine, side * 0.05, 0.42, 0);
    const int arm = add((lr + "Arm").c_str(), shoulder, side * 0.2, 0.42, 0);
    const int elbow = add((lr + "ForeArm").c_str(), arm, side * 0.48, 0.42, 0);
    add((lr + "Hand").c_str(), elbow, side * 0.74, 0.42, 0);
    const int leg = add((lr + "UpLeg").c_str(), hips, side * 0.1, -0.02, 0);
    const int knee = add((lr + "Leg").c_str(), leg, side * 0.1, -0.44, 0.01);
    const int foot = add((lr + "Foot").c_str(), knee, side * 0.1, -0.86, 0);
    add((lr + "ToeBase").c_str(), foot, side * 0.1, -0.92, 0.15);
  }
  return s;
}

std::vector<Vec3> sample_of(const Skeleton& skeleton, const Quat& turn = Quat::Identity()) {
  std::vector<Vec3> positions;
  for (const Transform& joint : skeleton.reference) positions.push_back(turn * joint.position);
  return positions;
}

Conventions detect(const Skeleton& skeleton, const std::vector<Vec3>& samples = {}) {
  return detect_conventions(skeleton, find_roles(skeleton), samples);
}

constexpr Direction kAll[] = {Direction::plus_x,  Direction::minus_x, Direction::plus_y,
                              Direction::minus_y, Direction::plus_z,  Direction::minus_z};

TEST(DetectConventions, FindsUpAndForwardInAllAxes) {
  for (const Direction up : kAll) {
    for (const Direction forward : kAll) {
      if (!rotation_to_krok(up, forward).ok()) continue;
      const Skeleton skeleton = person(1, up, forward);
      for (const auto& samples : {std::vector<Vec3>(), sample_of(skeleton)}) {
        const Conventions found = detect(skeleton, samples);
        EXPECT_EQ(found.up, up) << found.up_reason;
        EXPECT_EQ(found.forward, forward) << found.forward_reason;
        EXPECT_EQ(found.up_confidence, Confidence::certain);
        EXPECT_EQ(found.forward_confidence, Confidence::certain);
        EXPECT_EQ(found.reference_up, up);
        EXPECT_EQ(found.reference_forward, forward);
      }
    }
  }
}

TEST(DetectConventions, FindsTheUnit) {
  for (const char* name : {"m", "dm", "cm", "mm", "in", "ft", "cmu"}) {
    const double size = parse_unit(name)->metres;
    const Conventions found = detect(person(size, Direction::plus_z, Direction::minus_y));
    EXPECT_EQ(found.unit.name, name) << found.unit_reason;
    EXPECT_DOUBLE_EQ(found.unit.metres, size);
    EXPECT_NE(found.unit_confidence, Confidence::guess);
    EXPECT_FALSE(found.unit_reason.empty());
  }
}

TEST(DetectConventions, AActorOfAnUnusualSizeIsAGuess) {
  // Half a metre in metres could be anything.
  const Conventions found = detect(person(1 / 0.3, Direction::plus_y, Direction::plus_z));
  EXPECT_NE(found.unit_confidence, Confidence::certain);
}

// Would fail if a small body with a big head came out as a giant in inches without a warning.
TEST(DetectConventions, ProportionsThatAreNoPersonsLeaveARareUnitAGuess) {
  Skeleton small = person(0.01, Direction::plus_y, Direction::plus_z);
  for (Transform& joint : small.reference) {
    joint.position.y() *= joint.position.y() < 0 ? 0.45 : 0.65;
  }
  const Conventions found = detect(small);
  EXPECT_EQ(found.unit.name, "in");
  EXPECT_EQ(found.unit_confidence, Confidence::guess) << found.unit_reason;
}

TEST(DetectConventions, APoseDoesNotChangeTheUnit) {
  // The legs folded up beside the trunk: small extents, the same bones.
  Skeleton skeleton = person(0.01, Direction::plus_y, Direction::plus_z);
  for (const char* name :
       {"LeftLeg", "LeftFoot", "LeftToeBase", "RightLeg", "RightFoot", "RightToeBase"}) {
    auto& p = skeleton.reference[static_cast<std::size_t>(skeleton.find(name))].position;
    p.y() = -4 - p.y();
  }
  EXPECT_EQ(detect(skeleton).unit.name, "cm");
}

TEST(DetectConventions, AReferencePoseThatStandsOtherwiseThanTheMotionYieldsToIt) {
  const Skeleton skeleton = person(0.01, Direction::plus_y, Direction::plus_z);
  // The root turns the figure upright in a z-up world, facing -y there.
  const Quat turn = rotation_to_krok(Direction::plus_z, Direction::minus_y)->conjugate();
  const Conventions found = detect(skeleton, sample_of(skeleton, turn));
  EXPECT_EQ(found.up, Direction::plus_z);
  EXPECT_EQ(found.forward, Direction::minus_y);
  EXPECT_EQ(found.reference_up, Direction::plus_y);
  EXPECT_EQ(found.reference_forward, Direction::plus_z);
  EXPECT_NE(found.up_reason.find("the motion takes precedence"), std::string::npos)
      << found.up_reason;
}

// The person's joints as rigs have them whose bones all lie along their first axis: the pelvis has
// up along x, forward along y, left along z, and the legs fold up beside the trunk.
Skeleton folded_person() {
  Skeleton skeleton = person(1, Direction::plus_y, Direction::plus_z);
  const double hips_to_leg = -0.02;
  for (std::size_t j = 0; j < skeleton.names.size(); ++j) {
    Vec3& p = skeleton.reference[j].position;
    const bool below = p.y() < hips_to_leg;
    p = Vec3(below ? 2 * hips_to_leg - p.y() : p.y(), p.z(), p.x());
  }
  return skeleton;
}

// Else a character that was set down diagonally faces aside for ever, without a word.
TEST(DetectConventions, ADiagonalReferencePoseIsAGuess) {
  for (const double degrees : {20.0, 44.0}) {
    Skeleton turned = person(1, Direction::plus_y, Direction::plus_z);
    const Quat turn(Eigen::AngleAxisd(degrees * kRadiansPerDegree, Vec3::UnitY()));
    for (Transform& joint : turned.reference) joint = Transform{Vec3::Zero(), turn} * joint;
    const Conventions found = detect_conventions(turned, find_roles(turned), {});
    EXPECT_EQ(found.forward, Direction::plus_z);
    EXPECT_EQ(found.forward_confidence == Confidence::guess, degrees > 40) << found.forward_reason;
  }
}

TEST(DetectConventions, AReferencePoseThatDoesNotStandFacesWhereItsPelvisDoes) {
  const Skeleton folded = folded_person();
  const Skeleton upright = person(1, Direction::plus_y, Direction::plus_z);
  for (const double heading : {0.0, 60.0, 90.0, 180.0, 300.0}) {
    std::vector<Vec3> samples;
    for (int i = 0; i < 3; ++i) {
      const auto sample =
          sample_of(upright, axis_rotation(Axis::y, (heading + 10 * i) * kRadiansPerDegree));
      samples.insert(samples.end(), sample.begin(), sample.end());
    }
    const Conventions found = detect(folded, samples);
    EXPECT_EQ(found.up, Direction::plus_y);
    EXPECT_EQ(found.reference_up, Direction::plus_x) << heading;
    EXPECT_EQ(found.reference_forward, Direction::plus_y) << heading;
    // Takes of one skeleton agree, wherever the actor faces in them.
    EXPECT_EQ(found.forward, Direction::plus_z) << heading;
    EXPECT_EQ(found.forward_confidence, Confidence::guess) << heading;
  }
}

TEST(DetectConventions, APelvisThatStandsSaysWhereItFacesWhateverTheRestDoes) {
  for (const Direction forward : {Direction::plus_x, Direction::minus_z}) {
    Skeleton seated = person(1, Direction::plus_y, forward);
    for (const char* name : {"Neck", "Head", "LeftLeg", "RightLeg", "LeftFoot", "RightFoot",
                             "LeftToeBase", "RightToeBase"}) {
      Vec3& p = seated.reference[static_cast<std::size_t>(seated.find(name))].position;
      p += 0.6 * std::abs(p.y()) * direction_vector(forward);
      if (p.y() > 0.1) p.y() *= 0.5;
      if (p.y() < -0.1) p.y() = -0.1;
    }
    const Skeleton upright = person(1, Direction::plus_y, forward);
    for (const double heading : {0.0, 70.0, 190.0}) {
      const Conventions found =
          detect(seated, sample_of(upright, axis_rotation(Axis::y, heading * kRadiansPerDegree)));
      EXPECT_EQ(found.forward, forward) << heading << ": " << found.forward_reason;
    }
  }
}

TEST(DetectConventions, AFoldedReferencePoseWhosePelvisTellsNothingIsAsTheMotion) {
  const Skeleton upright = person(1, Direction::plus_y, Direction::plus_z);
  Skeleton folded = folded_person();
  for (const char* name : {"LeftUpLeg", "RightUpLeg", "Spine"}) {
    folded.reference[static_cast<std::size_t>(folded.find(name))].position.setZero();
  }
  const Conventions flat = detect(folded, sample_of(upright));
  EXPECT_EQ(flat.reference_up, flat.up);
  EXPECT_EQ(flat.reference_forward, flat.forward);
  // A file without frames has the reference pose of the takes of its skeleton.
  const Conventions still = detect(folded_person());
  EXPECT_EQ(still.reference_up, Direction::plus_x);
  EXPECT_EQ(still.reference_forward, Direction::plus_y);
}

// Takes of a skeleton whose reference pose does not stand, in which the actor lies, falls or gets
// up, have the axes of those in which it stands.
TEST(DetectConventions, TakesThatLieAgreeWithThoseThatStand) {
  Skeleton upright = person(1, Direction::plus_y, Direction::plus_z);
  for (Transform& joint : upright.reference) joint.position.y() += 0.94;
  // Not along +z: alone, such a take is one that stands in axes with z up.
  for (const double heading : {50.0, 90.0, 180.0, 270.0}) {
    const Quat lying = axis_rotation(Axis::y, heading * kRadiansPerDegree) *
                       axis_rotation(Axis::x, kPi / 2);  // on the front
    for (const int standing : {0, 4, 6}) {
      std::vector<Vec3> samples;
      for (int i = 0; i < 10; ++i) {
        auto sample = sample_of(upright, i < standing ? Quat::Identity() : lying);
        for (Vec3& p : sample) p.y() += i < standing ? 0 : 0.17;
        samples.insert(samples.end(), sample.begin(), sample.end());
      }
      const Conventions found = detect(folded_person(), samples);
      EXPECT_EQ(found.up, Direction::plus_y) << heading << ": " << found.up_reason;
      EXPECT_EQ(found.forward, Direction::plus_z) << heading;
      EXPECT_EQ(found.reference_up, Direction::plus_x) << heading;
      EXPECT_EQ(found.reference_forward, Direction::plus_y) << heading;
    }
  }
}

// Samples with the figure turned and then lifted, so that its lowest joint is `height` high.
std::vector<Vec3> lifted(const Skeleton& skeleton, const Quat& turn, const Vec3& up,
                         double height) {
  std::vector<Vec3> positions = sample_of(skeleton, turn);
  double lowest = INFINITY;
  for (const Vec3& p : positions) lowest = std::min(lowest, p.dot(up));
  for (Vec3& p : positions) p += (height - lowest) * up;
  return positions;
}

TEST(DetectConventions, AHandstandDoesNotTurnTheWorldOver) {
  const Skeleton skeleton = person(1, Direction::plus_y, Direction::plus_z);
  const Quat upside_down(0, 1, 0, 0);
  const Conventions found = detect(skeleton, lifted(skeleton, upside_down, Vec3::UnitY(), 0.02));
  EXPECT_EQ(found.up, Direction::plus_y) << found.up_reason;
  EXPECT_EQ(found.up_confidence, Confidence::guess);
}

// Samples of the character turned, its lowest joint at 0 along `up`, that travel along `ahead`.
std::vector<Vec3> travelling(const Skeleton& skeleton, const Quat& turn, Direction up,
                             Direction ahead) {
  std::vector<Vec3> all;
  for (int i = 0; i < 40; ++i) {
    for (const Vec3& p : lifted(skeleton, turn, direction_vector(up), 0.01 * (i % 3))) {
      all.push_back(p + 0.08 * i * direction_vector(ahead));
    }
  }
  return all;
}

// One rule for all axes, the opposite of the reference pose's included, as in a world with y down.
TEST(DetectConventions, AMotionThatWalksAlongAnotherAxisOverrulesTheReferencePose) {
  const Skeleton skeleton = person(1, Direction::plus_y, Direction::plus_z);
  for (const Direction up : kAll) {
    const Direction ahead =
        up == Direction::plus_x || up == Direction::minus_x ? Direction::plus_z : Direction::plus_x;
    const Quat turn = rotation_to_krok(up, ahead)->conjugate();
    const Conventions found = detect(skeleton, travelling(skeleton, turn, up, ahead));
    EXPECT_EQ(found.up, up) << found.up_reason;
    EXPECT_NE(found.up_confidence, Confidence::guess) << found.up_reason;
    EXPECT_EQ(found.reference_up, Direction::plus_y);
  }
}

// Prone and travelling head first. In unusual axes the answer may be wrong, but is then doubted.
TEST(DetectConventions, ACrawlDoesNotClimb) {
  Skeleton bent = folded_person();
  // A point of the world that never moves, as many exporters add, is no support.
  bent.names.insert(bent.names.begin(), "World");
  bent.parents.insert(bent.parents.begin(), -1);
  bent.end_sites.insert(bent.end_sites.begin(), 0);
  bent.reference.insert(bent.reference.begin(), Transform());
  for (std::size_t j = 1; j < bent.parents.size(); ++j) ++bent.parents[j];
  const Skeleton upright = person(1, Direction::plus_y, Direction::plus_z);
  const Quat prone = axis_rotation(Axis::x, kPi / 2);
  const auto crawl = travelling(upright, prone, Direction::plus_y, Direction::plus_z);
  for (const Direction up : kAll) {
    const Direction ahead = up == Direction::plus_y ? Direction::plus_z
                            : up == Direction::minus_y || up == Direction::plus_z
                                ? Direction::minus_x
                                : Direction::plus_y;
    if (!rotation_to_krok(up, ahead).ok()) continue;
    const Quat to_file = rotation_to_krok(up, ahead)->conjugate();
    std::vector<Vec3> samples;
    for (std::size_t i = 0; i < crawl.size(); ++i) {
      if (i % upright.names.size() == 0) samples.emplace_back(Vec3::Zero());
      samples.push_back(to_file * (crawl[i] + Vec3(0, 0.3, 0)));
    }
    const Conventions found = detect(bent, samples);
    if (up == Direction::plus_y || up == Direction::plus_z) {
      EXPECT_EQ(found.up, up) << found.up_reason;
      EXPECT_NE(found.up_reason.find("lie or crawl"), std::string::npos) << found.up_reason;
    }
    EXPECT_EQ(found.up_confidence, Confidence::guess) << found.up_reason;
  }
}

TEST(DetectConventions, NothingIsCertainWhereTheReferencePoseDoesNotStand) {
  const Skeleton upright = person(1, Direction::plus_y, Direction::plus_z);
  const Quat none = Quat::Identity();
  const Conventions found =
      detect(folded_person(), travelling(upright, none, Direction::plus_y, Direction::plus_z));
  EXPECT_EQ(found.up, Direction::plus_y);
  EXPECT_EQ(found.up_confidence, Confidence::likely) << found.up_reason;
}

// Somebody lies still, the feet at the origin and the hands a little in the ground. Would fail if
// he were taken for one who stands there, without a warning.
TEST(DetectConventions, WhoLiesStillWithFeetAtTheOriginMayLie) {
  const Skeleton upright = person(1, Direction::plus_y, Direction::plus_z);
  const Quat prone = axis_rotation(Axis::x, kPi / 2);
  std::vector<Vec3> samples;
  for (int frame = 0; frame < 3; ++frame) {
    for (const Vec3& joint : sample_of(upright, prone)) {
      samples.push_back(joint + Vec3(0, 0.05, 0.94));
    }
  }
  const Conventions found = detect(folded_person(), samples);
  EXPECT_EQ(found.up_confidence, Confidence::guess) << found.up_reason;
}

// The scale of a skeleton may be any: only the units that most files have are certain by height.
TEST(DetectConventions, ARareUnitIsNotCertainByHeightAlone) {
  for (const char* name : {"ft", "dm", "in"}) {
    const double size = parse_unit(name)->metres;
    EXPECT_EQ(detect(person(size, Direction::plus_y, Direction::plus_z)).unit_confidence,
              Confidence::likely)
        << name;
  }
  EXPECT_EQ(detect(person(0.01, Direction::plus_y, Direction::plus_z)).unit_confidence,
            Confidence::certain);
}

TEST(DetectConventions, AActorThatLiesOnTheGroundIsToldWithAWarning) {
  const Skeleton skeleton = person(0.01, Direction::plus_y, Direction::plus_z);
  // On its back and on its belly, hips above the ground.
  for (const double angle : {-80.0, 80.0}) {
    const Quat turn = axis_rotation(Axis::x, angle * kRadiansPerDegree);
    const Conventions found = detect(skeleton, lifted(skeleton, turn, Vec3::UnitY(), 1));
    EXPECT_EQ(found.up, Direction::plus_y) << found.up_reason;
    EXPECT_EQ(found.up_confidence, Confidence::guess);
    EXPECT_EQ(found.forward, Direction::plus_z) << found.forward_reason;
  }
}

TEST(DetectConventions, AActorThatFallsAndLiesDoesNotTurnTheWorld) {
  const Skeleton skeleton = person(0.01, Direction::plus_y, Direction::plus_z);
  // It stands in a third of the motion and lies on its back or its belly from then on.
  for (const double angle : {-90.0, 90.0}) {
    const Quat turn = axis_rotation(Axis::x, angle * kRadiansPerDegree);
    std::vector<Vec3> samples;
    for (int i = 0; i < 9; ++i) {
      const auto sample = i < 3 ? lifted(skeleton, Quat::Identity(), Vec3::UnitY(), 1)
                                : lifted(skeleton, turn, Vec3::UnitY(), 1);
      samples.insert(samples.end(), sample.begin(), sample.end());
    }
    const Conventions found = detect(skeleton, samples);
    EXPECT_EQ(found.up, Direction::plus_y) << found.up_reason;
    EXPECT_EQ(found.up_confidence, Confidence::likely);
    EXPECT_EQ(found.forward, Direction::plus_z) << found.forward_reason;
  }
}

// An animal of `person`'s joints, trunk level at the height of its legs, head before it: along +y,
// facing +z.
std::vector<Vec3> on_all_fours(const Skeleton& skeleton, const Vec3& place) {
  std::vector<Vec3> positions;
  for (std::size_t j = 0; j < skeleton.names.size(); ++j) {
    const Vec3& p = skeleton.reference[j].position;
    const bool leg = p.y() < 0;
    const bool arm = std::abs(p.x()) > 0.1 && !leg;
    const double down = arm ? std::abs(p.x()) - 0.2 : 0;
    positions.push_back(place + Vec3(0, 0.92, 0) +
                        (leg   ? p
                         : arm ? Vec3(p.x() > 0 ? 0.15 : -0.15, -1.6 * down, 0.84)
                               : Vec3(p.x(), 0, 2 * p.y())));
  }
  return positions;
}

// An animal with a person's names on a floor that is not at 0; its reference pose is a bundle, as
// zero rotations often are.
TEST(DetectConventions, AnAnimalWalksOnAFloor) {
  Skeleton skeleton = person(1, Direction::plus_y, Direction::plus_z);
  std::vector<Vec3> walk, sit;
  for (int i = 0; i < 40; ++i) {
    for (const Vec3& p : on_all_fours(skeleton, {0.3 * i, 3 + 0.01 * (i % 3), 0.4 * i})) {
      walk.push_back(p);
    }
    for (const Vec3& p : on_all_fours(skeleton, {0, 3, 0})) sit.push_back(p);
  }
  for (std::size_t j = 0; j < skeleton.names.size(); ++j) {
    if (skeleton.names[j].find("Leg") != std::string::npos ||
        skeleton.names[j].find("Foot") != std::string::npos ||
        skeleton.names[j].find("Toe") != std::string::npos) {
      skeleton.reference[j].position.y() *= -1;
    }
  }
  const Conventions found = detect(skeleton, walk);
  EXPECT_EQ(found.up, Direction::plus_y) << found.up_reason;
  EXPECT_EQ(found.up_confidence, Confidence::guess);
  EXPECT_NE(found.up_reason.find("keeps its height"), std::string::npos) << found.up_reason;
  EXPECT_EQ(found.forward, Direction::plus_z) << found.forward_reason;
  EXPECT_EQ(detect(skeleton, sit).up_confidence, Confidence::guess);
}

TEST(DetectConventions, AMotionThatIsUpsideDownThroughoutIsAGuess) {
  const Skeleton skeleton = person(1, Direction::plus_y, Direction::plus_z);
  const Conventions found = detect(skeleton, sample_of(skeleton, Quat(0, 1, 0, 0)));
  EXPECT_EQ(found.up_confidence, Confidence::guess);
  EXPECT_NE(found.up_reason.find("upside down"), std::string::npos) << found.up_reason;
}

TEST(DetectConventions, AActorThatLiesOnTheGroundAlongAnUnusualAxisIsNotUpright) {
  const Skeleton skeleton = person(0.01, Direction::plus_y, Direction::plus_z);
  // Up along -z, with the feet at z = 0 by chance.
  const Quat turn = axis_rotation(Axis::x, -80 * kRadiansPerDegree);
  std::vector<Vec3> sample = lifted(skeleton, turn, Vec3::UnitY(), 1);
  double lowest = INFINITY;
  for (const Vec3& p : sample) lowest = std::min(lowest, -p.z());
  for (Vec3& p : sample) p.z() += lowest;
  const Conventions found = detect(skeleton, sample);
  EXPECT_EQ(found.up, Direction::plus_y) << found.up_reason;
  EXPECT_EQ(found.up_confidence, Confidence::guess);
}

TEST(DetectConventions, AActorUprightAlongAnUnusualAxisAwayFromTheGroundIsAGuess) {
  const Skeleton skeleton = person(0.01, Direction::plus_y, Direction::plus_z);
  const Quat turn = axis_rotation(Axis::x, -90 * kRadiansPerDegree);  // up along -z
  const Conventions found = detect(skeleton, lifted(skeleton, turn, Vec3::UnitY(), 700));
  EXPECT_EQ(found.up_confidence, Confidence::guess) << found.up_reason;
  EXPECT_EQ(found.up, Direction::minus_z);  // as for +z
}

TEST(DetectConventions, TheGroundConfirmsAMotionThatStandsOtherwiseThanTheReferencePose) {
  const Skeleton skeleton = person(0.01, Direction::plus_y, Direction::plus_z);
  const Quat turn = rotation_to_krok(Direction::plus_z, Direction::minus_y)->conjugate();
  const Conventions found = detect(skeleton, lifted(skeleton, turn, Vec3::UnitZ(), 2));
  EXPECT_EQ(found.up, Direction::plus_z);
  EXPECT_EQ(found.up_confidence, Confidence::certain) << found.up_reason;
}

TEST(DetectConventions, ATrunkAloneTellsUp) {
  Skeleton skeleton;
  const Mat3 to_file =
      rotation_to_krok(Direction::plus_z, Direction::minus_y)->conjugate().toRotationMatrix();
  const auto add = [&](const char* name, int parent, double x, double y) {
    return skeleton.add(name, parent, {to_file * Vec3(x, y, 0), Quat::Identity()});
  };
  const int hips = add("Hips", -1, 0, 1);
  const int chest = add("Chest", hips, 0, 1.3);
  add("Head", add("Neck", chest, 0, 1.5), 0, 1.6);
  for (const double side : {1.0, -1.0}) {
    const std::string lr = side > 0 ? "Left" : "Right";
    const int arm = add((lr + "Arm").c_str(), chest, 0.2 * side, 1.45);
    add((lr + "Hand").c_str(), add((lr + "ForeArm").c_str(), arm, 0.5 * side, 1.45), 0.7 * side,
        1.45);
  }
  const Conventions found = detect(skeleton, sample_of(skeleton));
  EXPECT_EQ(found.up, Direction::plus_z) << found.up_reason;
  EXPECT_EQ(found.up_confidence, Confidence::likely);
}

TEST(DetectConventions, TurningOnTheSpotLeavesForwardToTheReferencePose) {
  const Skeleton skeleton = person(1, Direction::plus_y, Direction::plus_z);
  const Quat about(0, 0, 1, 0);
  const Conventions found = detect(skeleton, sample_of(skeleton, about));
  EXPECT_EQ(found.forward, Direction::plus_z) << found.forward_reason;
}

TEST(DetectConventions, ToesThatPointBackMakeForwardAGuess) {
  Skeleton skeleton = person(1, Direction::plus_y, Direction::plus_z);
  for (const char* name : {"LeftToeBase", "RightToeBase"}) {
    skeleton.reference[static_cast<std::size_t>(skeleton.find(name))].position.z() = -0.15;
  }
  const Conventions found = detect(skeleton);
  EXPECT_EQ(found.forward_confidence, Confidence::guess);
  EXPECT_NE(found.forward_reason.find("toes"), std::string::npos);
}

TEST(DetectConventions, WhatIsNoPersonGetsDefaults) {
  Skeleton chain;
  chain.add("base", -1, {});
  chain.add("tip", 0, {Vec3(0, 120, 0), Quat::Identity()});
  const Conventions found = detect(chain);
  EXPECT_EQ(found.up, Direction::plus_y);
  EXPECT_EQ(found.forward, Direction::plus_z);
  EXPECT_EQ(found.unit.name, "cm");
  EXPECT_EQ(found.unit_confidence, Confidence::guess);
  EXPECT_EQ(found.up_confidence, Confidence::guess);
  EXPECT_EQ(found.forward_confidence, Confidence::guess);
}

TEST(DetectConventions, SurvivesEmptyAndDegenerateInput) {
  EXPECT_EQ(detect({}).unit.name, "m");
  Skeleton flat = person(1, Direction::plus_y, Direction::plus_z);
  for (Transform& joint : flat.reference) joint.position.setZero();
  const Conventions nothing = detect(flat, sample_of(flat));
  EXPECT_TRUE(std::isfinite(nothing.unit.metres));
  EXPECT_EQ(nothing.up_confidence, Confidence::guess);
  const Skeleton good = person(1, Direction::plus_y, Direction::plus_z);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
    const Conventions in_samples =
        detect(good, std::vector<Vec3>(good.names.size(), Vec3::Constant(bad)));
    EXPECT_EQ(in_samples.unit.name, "m");
    EXPECT_EQ(in_samples.up, Direction::plus_y);
    Skeleton broken = good;
    for (Transform& joint : broken.reference) joint.position.setConstant(bad);
    EXPECT_TRUE(std::isfinite(detect(broken).unit.metres));
    EXPECT_EQ(detect(broken, sample_of(good)).up, Direction::plus_y);
  }
}

TEST(DetectConventions, TakesTheLengthsFromTheMotionWhereTheReferencePoseHasNone) {
  const Skeleton good = person(0.01, Direction::plus_y, Direction::plus_z);
  Skeleton collapsed = good;
  for (Transform& joint : collapsed.reference) joint.position.setZero();
  EXPECT_EQ(detect(collapsed, sample_of(good)).unit.name, "cm");
}

TEST(RotationToKrok, TakesUpToYAndForwardToZ) {
  for (const Direction up : kAll) {
    for (const Direction forward : kAll) {
      const auto rotation = rotation_to_krok(up, forward);
      if (direction_vector(up).cross(direction_vector(forward)).isZero()) {
        ASSERT_FALSE(rotation.ok());
        EXPECT_EQ(rotation.error().code, "direction-parallel");
        continue;
      }
      ASSERT_TRUE(rotation.ok());
      EXPECT_TRUE((*rotation * direction_vector(up)).isApprox(Vec3::UnitY(), 1e-15));
      EXPECT_TRUE((*rotation * direction_vector(forward)).isApprox(Vec3::UnitZ(), 1e-15));
      EXPECT_NEAR(rotation->norm(), 1, 1e-15);
    }
  }
}

// Numbers in Krok's own frame must pass unconverted.
TEST(RotationToKrok, IsExactlyTheIdentityForKroksFrame) {
  const Quat q = *rotation_to_krok(Direction::plus_y, Direction::plus_z);
  EXPECT_EQ(q.coeffs(), Quat::Identity().coeffs());
}

TEST(Directions, NamesReadBack) {
  for (const Direction d : kAll) EXPECT_EQ(*parse_direction(direction_name(d)), d);
  EXPECT_EQ(*parse_direction("+y"), Direction::plus_y);
  EXPECT_EQ(*parse_direction("-Z"), Direction::minus_z);
  for (const char* text : {"", "+", "-", "w", "+-x", "--x", "xy"}) {
    const auto parsed = parse_direction(text);
    ASSERT_FALSE(parsed.ok()) << text;
    EXPECT_EQ(parsed.error().code, "direction-unknown");
  }
}

TEST(Units, AreParsed) {
  EXPECT_DOUBLE_EQ(parse_unit("cm")->metres, 0.01);
  EXPECT_DOUBLE_EQ(parse_unit("cmu")->metres, 0.0254 / 0.45);
  EXPECT_DOUBLE_EQ(parse_unit("5.64cm")->metres, 0.0564);
  EXPECT_DOUBLE_EQ(parse_unit("1e-1m")->metres, 0.1);
  for (const char* text : {"", "auto", "1", "0cm", "-1cm", "km", "nan", "infm", "cm2"}) {
    const auto parsed = parse_unit(text);
    ASSERT_FALSE(parsed.ok()) << text;
    EXPECT_EQ(parsed.error().code, "unit-unknown");
    EXPECT_FALSE(parsed.error().hint.empty());
  }
}

TEST(Conventions, SizesThatAreNoneAreNotCalledSensible) {
  const auto reason = [](double length) {
    Skeleton rod;
    rod.add("a", -1, Transform());
    rod.add("b", 0, {Vec3(0, length, 0), Quat::Identity()});
    return detect_conventions(rod, find_roles(rod), {}).unit_reason;
  };
  EXPECT_NE(reason(2).find("is assumed plausible"), std::string::npos);
  for (const double length : {0.0, 2e-10, 1e9}) {
    EXPECT_EQ(reason(length).find("is assumed plausible"), std::string::npos) << reason(length);
  }
  EXPECT_NE(reason(0).find("all joints coincide"), std::string::npos);
  for (const double metres_per_unit : {1e-8, 1e8}) {
    const Skeleton actor = person(metres_per_unit, Direction::plus_y, Direction::plus_z);
    const Conventions found = detect_conventions(actor, find_roles(actor), {});
    EXPECT_EQ(found.unit_confidence, Confidence::guess);
    EXPECT_NE(found.unit_reason.find("no common unit"), std::string::npos) << found.unit_reason;
    EXPECT_EQ(found.unit_reason.find("about"), std::string::npos) << found.unit_reason;
  }
}

}  // namespace
}  // namespace krok
