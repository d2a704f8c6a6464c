#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "support/run_tool.h"

namespace krok::test {

// What a run left: several tests look at it, in whatever process they are.
struct Made {
  std::filesystem::path folder;
  ToolRun run;  // exit_code, out and err alone
};

// Calls `make` with a new folder, test_results/made/NAME of the build, unless another test has done
// so with the same tools and files of `source`, the folder that `make` runs. Others wait meanwhile.
// What is made must not be changed afterwards.
Made made_once(const std::string& name, const std::filesystem::path& source,
               const std::function<ToolRun(const std::filesystem::path& folder)>& make);

}  // namespace krok::test
