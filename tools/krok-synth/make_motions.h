#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "formats/container/packed_orientation.h"
#include "tools/common/tool.h"

namespace krok::synth_tool {

enum class SideChoice : unsigned char { library, left, right };

struct Options {
  std::string library;
  std::vector<std::string> set;  // NAME=VALUE
  std::string table;
  SideChoice side = SideChoice::library;
  bool correct = false;
  bool extrapolate = false;
  double rate = 0;  // 0: the library's
  OrientationEncoding orientation = OrientationEncoding::xyz;
};

void declare(CommandOptions& command, Options& options);
Status check(const Options& options);
Result<int> run(const Options& options, ToolContext& context);

}  // namespace krok::synth_tool
