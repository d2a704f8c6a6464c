#pragma once

#include <optional>
#include <string_view>

#include "formats/bvh/hierarchy.h"

namespace krok::bvh {

struct ChannelMeaning {
  ChannelKind kind = ChannelKind::ignored;
  Axis axis = Axis::x;
};

// Parses a channel name, case-insensitive; nullopt if it is not a BVH channel.
std::optional<ChannelMeaning> channel_meaning(std::string_view name);

// "Xrotation"; "unknown" for ignored channels.
std::string_view channel_name(ChannelKind kind, Axis axis);

}  // namespace krok::bvh
