#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "capture/conventions.h"

namespace krok::io {

// The BVH files of a batch, in which takes of one skeleton are to have the same axes: one that
// lies or crawls does not show them by itself. Thread-safe; the answers depend on neither the
// order of the questions nor the number of threads.
class Takes {
 public:
  // Of all shards, in any order; files that are no BVH do no harm.
  explicit Takes(std::vector<std::string> paths) : paths_(std::move(paths)) {}

  struct Axes {
    Direction up, forward, reference_up, reference_forward;
    Confidence confidence, forward_confidence;  // at most likely
    std::string reason;                         // a sentence without a full stop
    std::vector<std::string> from;              // the takes that were asked
  };

  // What most takes with the hierarchy of `text` show, each weighted by its confidence. At most 8
  // are asked, spread over the sorted paths. The root's OFFSET may differ. Empty without another.
  std::optional<Axes> axes_for(std::string_view text);

 private:
  struct Group {
    std::vector<std::string> paths;
    std::optional<Axes> axes;
  };

  void find_groups();

  std::mutex mutex_;
  std::vector<std::string> paths_;
  bool found_ = false;
  std::map<std::uint64_t, Group> groups_;
};

}  // namespace krok::io
