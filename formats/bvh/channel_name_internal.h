#pragma once

#include <optional>
#include <string_view>

#include "formats/bvh/hierarchy.h"

namespace krok::bvh {

struct ChannelMeaning {
  ChannelKind kind = ChannelKind::ignored;
  Axis axis = Axis::x;
};

// What the name of a channel means, in any case; nothing for one that is not of the format.
std::optional<ChannelMeaning> channel_meaning(std::string_view name);

// "Xrotation"; "unknown" for what is ignored.
std::string_view channel_name(ChannelKind kind, Axis axis);

}  // namespace krok::bvh
