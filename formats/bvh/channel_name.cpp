#include <array>

#include "core/text.h"
#include "formats/bvh/channel_name_internal.h"

namespace krok::bvh {

namespace {

struct ChannelName {
  std::string_view name;
  ChannelMeaning meaning;
};

constexpr std::array kChannelNames = {ChannelName{"Xposition", {ChannelKind::position, Axis::x}},
                                      ChannelName{"Yposition", {ChannelKind::position, Axis::y}},
                                      ChannelName{"Zposition", {ChannelKind::position, Axis::z}},
                                      ChannelName{"Xrotation", {ChannelKind::rotation, Axis::x}},
                                      ChannelName{"Yrotation", {ChannelKind::rotation, Axis::y}},
                                      ChannelName{"Zrotation", {ChannelKind::rotation, Axis::z}}};

}  // namespace

std::optional<ChannelMeaning> channel_meaning(std::string_view name) {
  for (const ChannelName& candidate : kChannelNames) {
    if (same_word(name, candidate.name)) return candidate.meaning;
  }
  return std::nullopt;
}

std::string_view channel_name(ChannelKind kind, Axis axis) {
  for (const ChannelName& candidate : kChannelNames) {
    if (candidate.meaning.kind == kind && candidate.meaning.axis == axis) return candidate.name;
  }
  return "unknown";
}

}  // namespace krok::bvh
