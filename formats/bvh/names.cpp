#include "formats/bvh/names.h"

#include <fmt/format.h>

#include "capture/joint_name.h"
#include "capture/unique_names.h"
#include "core/numbers.h"
#include "core/text.h"

namespace krok::bvh {

namespace {

// Limits the number of messages.
constexpr int kMaxWarnings = 20;

}  // namespace

void make_names_unique(std::vector<JointName>& places, std::string_view text,
                       const std::string& file_name, Diagnostics& diagnostics) {
  Locator locate(text, file_name);
  int duplicates = 0;
  int recoded = 0;
  int cleaned = 0;
  int nameless = 0;
  const auto warn = [&](const JointName& place, const char* code, std::string message) {
    Diagnostic warning = make_warning(code, std::move(message));
    warning.where = locate(place.offset);
    warning.joint = *place.name;
    diagnostics.push_back(std::move(warning));
  };

  UniqueNames names;
  std::vector<std::size_t> renamed;
  // Claims names from the file first, so that a generated name never displaces one of them.
  for (std::size_t i = 0; i < places.size(); ++i) {
    JointName& place = places[i];
    if (place.end_site) continue;
    if (!is_utf8(*place.name)) {
      *place.name = to_utf8(*place.name);
      if (++recoded <= kMaxWarnings) {
        warn(place, "bvh-name",
             fmt::format("the name of joint {} is not UTF-8 and was read as Latin-1", *place.name));
      }
    }
    std::string cleaned_name = readable_joint_name(*place.name);
    if (cleaned_name != *place.name) {
      *place.name = std::move(cleaned_name);
      if (++cleaned <= kMaxWarnings) {
        warn(place, "bvh-name",
             fmt::format("a joint name has control characters; renamed to {}", *place.name));
      }
    }
    if (place.name->empty() || !names.claim(*place.name)) renamed.push_back(i);
  }
  for (const std::size_t i : renamed) {
    JointName& place = places[i];
    const std::string given = *place.name;
    *place.name = names.make(given.empty() ? "joint" : given);
    if (given.empty() && ++nameless <= kMaxWarnings) {
      warn(place, "bvh-name", fmt::format("a joint without a name is named {}", *place.name));
    }
    if (!given.empty() && ++duplicates <= kMaxWarnings) {
      warn(place, "bvh-name-duplicate",
           fmt::format("duplicate joint name {}; renamed to {}", given, *place.name));
    }
  }
  if (duplicates > kMaxWarnings) {
    Diagnostic more =
        make_warning("bvh-name-duplicate",
                     fmt::format("{} with a duplicate name",
                                 counted(duplicates - kMaxWarnings, "more joint", "more joints")));
    more.where.file = file_name;
    diagnostics.push_back(std::move(more));
  }
  for (JointName& place : places) {
    if (!place.end_site) continue;
    *place.name = names.make(*places[static_cast<std::size_t>(place.parent)].name + "_end");
  }
}

std::string readable_name(std::string_view name) {
  return name.empty() ? "a joint without a name" : shown(name);
}

}  // namespace krok::bvh
