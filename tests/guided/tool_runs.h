#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "tools/cli/tool.h"

// The tools' own code, run in this process on files of a folder that is removed with the program.

namespace krok::guided {

// A file's path in that folder.
std::string scratch(const std::string& name);

// Removes all files of the folder, so that an earlier input's is not taken for a result.
void clear_scratch();

std::string content_of(const std::string& path);

inline std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

// Whether the tool did its work. fail() if it ends neither with success nor with a refusal, or
// takes more than 4 times the memory of the files that it reads and writes, and 64 MiB.
bool run_tool(const cli::MakeToolSpec& make_spec, std::vector<std::string> arguments);

// Each fails if the file is not what a tool may write.
void judge_report(const std::string& path);
void judge_motion(const std::string& path);
void judge_model(const std::string& path);
void judge_gltf(const std::string& path);
void judge_table(const std::string& path);
void judge_chart(const std::string& path);

}  // namespace krok::guided
