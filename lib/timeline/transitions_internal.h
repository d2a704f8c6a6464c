#pragma once

#include <memory>
#include <set>
#include <vector>

#include "timeline/base_motion.h"
#include "timeline/join_state.h"

// Shared by all kinds of transitions.

namespace krok::timeline {

// make_transition() for each kind.
std::unique_ptr<Transition> make_crossfade(const TransitionSides& sides, bool& on_feet);
std::unique_ptr<Transition> make_smooth(const TransitionSides& sides, bool& on_feet);
std::unique_ptr<Transition> make_inertial(const TransitionSides& sides, bool& on_feet);

const Skeleton& skeleton_of(const TransitionSides& sides);

// World positions of the joints.
std::vector<Vec3> places_of_joints(const Skeleton& skeleton, const ActorPose& pose);

// Joints with contacts in either motion.
std::set<int> contact_joints(const TransitionSides& sides);

// Moves `place`, the ground frame of the next motion, so that joints in contact in both poses (the
// previous motion's last and the next motion's first) stay planted. False if there are none.
bool stand_on_feet(const TransitionSides& sides, const ActorPose& previous, const ActorPose& next,
                   GroundFrame& place);

// Positions the next motion where the previous one leaves the character.
void put_next(const TransitionSides& sides, const ActorPose& left, bool& on_feet);

// Pose and derivatives at the end of the previous motion (from earlier frames) and at the start of
// the next one (from later frames).
ActorState state_before(const TransitionSides& sides);
ActorState state_after(const TransitionSides& sides);

}  // namespace krok::timeline
