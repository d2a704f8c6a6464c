#pragma once

#include <vector>

#include "samples/generator/curves.h"
#include "samples/generator/foot_plan.h"

// The motion of one foot: rolls over its footprints without skating and swings between them.

namespace krok::samples {

struct FootPose {
  Vec3 ankle = Vec3::Zero();
  Quat foot = Quat::Identity();  // foot_to_world
  Quat toes = Quat::Identity();  // toes_to_world
};

// In stance the foot rotates about the heel contact point while its toes point up, about the toe
// joint (with flat toes) while its heel is up, and finally about the tip of the toes. The swing
// moves the ankle from toe-off to the next strike with continuous velocity and acceleration, lifted
// and held back as far as ground clearance requires.
class FootMotion {
 public:
  FootMotion(Side side, const FootPlan& plan, const Actor& actor);

  FootPose at(double time) const;

  // The footprint that the foot is on or has left last.
  const Footprint& print_at(double time) const;

 private:
  struct Swing {
    State<Vec3> from, to;  // of the ankle
    double lift = 0;       // metres
    double hold_back = 0;  // metres, against the direction of the step
    int climb = 0;         // +1 up stairs, -1 down, 0 otherwise
    Vec3 direction = Vec3::Zero();
  };

  double pitch_at(std::size_t print, double time) const;
  double toe_extension_at(std::size_t print, double time) const;
  double toe_pitch_at(std::size_t print, double time) const;
  FootPose stance(std::size_t print, double time) const;
  FootPose swing(std::size_t print, double time) const;
  State<Vec3> ankle_state(std::size_t print, const State<double>& foot_pitch,
                          const State<double>& toe_pitch) const;
  void clear_ground(std::size_t print, const FootPlan& plan);
  std::size_t index_at(double time) const;

  Actor actor_;
  double stride_ = 0;
  std::vector<Footprint> prints_;
  std::vector<KnotCurve> pitch_;          // from print i's strike to the strike of print i + 1
  std::vector<KnotCurve> toe_extension_;  // in the swing from print i to i + 1
  std::vector<Swing> swings_;             // from print i to i + 1
};

}  // namespace krok::samples
