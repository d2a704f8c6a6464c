#include <fmt/format.h>

#include <algorithm>

#include "core/index.h"
#include "core/text.h"
#include "formats/ragdoll/ragdoll_format.h"
#include "formats/ragdoll/reader_internal.h"

namespace krok::ragdoll_file {

namespace {
constexpr std::string_view kWhole = "the file";
constexpr std::size_t kLargestFile = std::size_t{16} << 20;
constexpr std::size_t kMaxBodies = 1000, kMaxJoints = 4000;
}  // namespace

using json::Value;
using ragdoll::JointRule;

Status Reader::read_list(const Value& root, std::string_view key, std::size_t least,
                         std::size_t most, ReadEntry entry) {
  const auto list = in_.get(root, kWhole, key, Value::Kind::array);
  if (!list) return list.error();
  const std::size_t count = (*list)->items.size();
  if (count < least || count > most) {
    return in_.wrong(**list, fmt::format("{} {}, expected {} to {}", count, key, least, most));
  }
  for (const Value& item : (*list)->items) {
    if (Status status = (this->*entry)(item); !status) return status;
  }
  return {};
}

// Each body but the root is tied to the one above it, else it would leave its joint's place.
Status Reader::check_ties(const Value& root) const {
  const Value& bodies = *root.find("bodies");
  for (std::size_t b = 1; b < read_.bodies.size(); ++b) {
    const bool tied = std::ranges::any_of(read_.joints, [&](const JointRule& rule) {
      return rule.child == static_cast<int>(b) && rule.parent == read_.bodies[b].parent;
    });
    if (tied || skeleton_ == nullptr) continue;
    const std::string& above = read_.bodies[at(read_.bodies[b].parent)].name;
    return json::error_at(text_, bodies.items[b].offset, "ragdoll-body",
                          fmt::format("no joint ties '{}' to '{}', the body above it",
                                      shown(read_.bodies[b].name), shown(above)),
                          "add one to \"joints\"");
  }
  return {};
}

Result<ragdoll::Ragdoll> Reader::read() {
  const auto root = json::parse(text_, kLargestFile);
  if (!root) return root.error();
  Status status = in_.only(*root, kWhole, {"schema", "comment", "bodies", "joints"});
  if (status) status = in_.has_schema(*root, kWhole, "krok.ragdoll/1");
  if (status) status = read_list(*root, "bodies", 1, kMaxBodies, &Reader::read_body);
  if (status) status = read_list(*root, "joints", 0, kMaxJoints, &Reader::read_joint);
  if (status) status = check_ties(*root);
  if (!status) return status.error();
  return std::move(read_);
}

Result<ragdoll::Ragdoll> read(std::string_view text, const Skeleton* skeleton) {
  return Reader(text, skeleton).read();
}

}  // namespace krok::ragdoll_file
