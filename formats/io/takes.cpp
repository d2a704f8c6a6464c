#include "formats/io/takes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/file.h"
#include "core/hash.h"
#include "formats/bvh/bvh_reader.h"

namespace krok::io {

namespace {

// Of the hierarchy without the root's OFFSET, which some programs take from the first frame.
std::uint64_t key_of(std::string_view text) {
  std::string hierarchy(text.substr(0, text.find("MOTION")));
  const std::size_t offset = hierarchy.find("OFFSET");
  if (offset != std::string::npos) {
    hierarchy.erase(offset, std::min(hierarchy.find('\n', offset), hierarchy.size()) - offset);
  }
  return xxh3(std::as_bytes(std::span(hierarchy)));
}

std::optional<Conventions> conventions_of(const std::string& path) {
  const auto file = InputFile::open(path);
  if (!file) return std::nullopt;
  bvh::ReadOptions options;
  options.jobs = 1;
  if (const auto opened = bvh::open(file->text(), path, options)) return opened->conventions;
  auto read = bvh::read(file->text(), path, options);
  return read ? std::optional(read->conventions) : std::nullopt;
}

std::optional<Takes::Axes> vote(const std::vector<std::string>& paths) {
  constexpr std::size_t kAsked = 8;
  constexpr std::array kWeights = {1, 4, 16};  // of a guess, a likely axis, a certain one
  struct Votes {
    Conventions conventions;
    int weight = 0, count = 0;
  };
  std::map<std::array<Direction, 4>, Votes> all;
  std::vector<std::string> from;
  const std::size_t asked = std::min(kAsked, paths.size());
  for (std::size_t i = 0; i < asked; ++i) {
    from.push_back(paths[i * (paths.size() - 1) / (asked - 1)]);
    const auto found = conventions_of(from.back());
    if (!found) continue;
    Votes& votes = all[{found->up, found->forward, found->reference_up, found->reference_forward}];
    votes.weight += kWeights[static_cast<std::size_t>(found->up_confidence)];
    ++votes.count;
    if (votes.count == 1 || found->up_confidence > votes.conventions.up_confidence) {
      votes.conventions = *found;
    }
  }
  if (all.empty()) return std::nullopt;
  const auto& most =
      std::ranges::max_element(all, {}, [](const auto& one) { return one.second.weight; })->second;
  const Conventions& found = most.conventions;
  return Takes::Axes{
      found.up,
      found.forward,
      found.reference_up,
      found.reference_forward,
      std::min(found.up_confidence, Confidence::likely),
      std::min(found.forward_confidence, Confidence::likely),
      fmt::format("{} of {} takes of this skeleton in the batch have up {}, forward "
                  "{}",
                  most.count, asked, direction_name(found.up), direction_name(found.forward)),
      from};
}

}  // namespace

void Takes::find_groups() {
  if (std::exchange(found_, true)) return;
  std::ranges::sort(paths_);
  for (const std::string& path : paths_) {
    const auto file = InputFile::open(path);
    if (file && file->text().find("HIERARCHY") < 1000)
      groups_[key_of(file->text())].paths.push_back(path);
  }
}

std::optional<Takes::Axes> Takes::axes_for(std::string_view text) {
  const std::lock_guard lock(mutex_);
  find_groups();
  const auto group = groups_.find(key_of(text));
  if (group == groups_.end() || group->second.paths.size() < 2) return std::nullopt;
  if (!group->second.axes) group->second.axes = vote(group->second.paths);
  return group->second.axes;
}

}  // namespace krok::io
