#pragma once

#include <memory>
#include <set>
#include <vector>

#include "timeline/base_motion.h"
#include "timeline/join_state.h"

// What the kinds of transitions share.

namespace krok::timeline {

// Those of make_transition(), one kind each.
std::unique_ptr<Transition> make_crossfade(const TransitionSides& sides, bool& on_feet);
std::unique_ptr<Transition> make_smooth(const TransitionSides& sides, bool& on_feet);
std::unique_ptr<Transition> make_inertial(const TransitionSides& sides, bool& on_feet);

const Skeleton& skeleton_of(const TransitionSides& sides);

// Positions in the world.
std::vector<Vec3> places_of_joints(const Skeleton& skeleton, const ActorPose& pose);

// Joints that contacts of either motion tell of.
std::set<int> contact_joints(const TransitionSides& sides);

// Moves the place where the next figure stands so that the joints that stand in both poses, the
// previous one's last and the next one's first, stay where they are. False where there are none.
bool stand_on_feet(const TransitionSides& sides, const ActorPose& previous, const ActorPose& next,
                   GroundFrame& place);

// Puts the next motion where the previous one leaves the figure.
void put_next(const TransitionSides& sides, const ActorPose& left, bool& on_feet);

// The figure where the one motion is left and the other entered, and how it moves there: by what is
// played before, and by what is played after.
ActorState state_before(const TransitionSides& sides);
ActorState state_after(const TransitionSides& sides);

}  // namespace krok::timeline
