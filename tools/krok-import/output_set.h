#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/file.h"
#include "core/result.h"
#include "tools/common/tool.h"

namespace krok::import {

// The files that one run writes: all of them appear or none.
class OutputSet {
 public:
  explicit OutputSet(ToolContext& context) : context_(context) {}

  // Writes a file beside its place; nothing for an empty path. An Error (code usage) if another
  // output has the same name.
  Status add(const std::string& path, const std::function<Status(OutputFile&)>& write);

  // Puts all in place once each is safe on the disk.
  Status finish();

  // The names so far, for people.
  std::string names() const;

 private:
  ToolContext& context_;
  std::vector<std::pair<std::string, OutputFile>> files_;
};

}  // namespace krok::import
