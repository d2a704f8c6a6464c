#pragma once

#include <string_view>

namespace krok::ragdoll {

// How a body moves during the simulation.
enum class BodyMode : unsigned char {
  simulated,  // by gravity, by contacts and with what it hangs from
  animated,   // as the motion has it, whatever it touches, and so does the body above it
  powered     // as simulated, but a motor in its joint follows the motion; the root body, which has
              // no joint, follows it by a spring from outside
};

std::string_view body_mode_name(BodyMode mode);  // "powered"

}  // namespace krok::ragdoll
