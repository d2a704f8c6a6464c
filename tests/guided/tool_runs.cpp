#include "guided/tool_runs.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "formats/anim/anim.h"
#include "formats/csv/table.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/model/model_format.h"
#include "guided/memory_watch.h"
#include "guided/targets.h"

namespace krok::guided {

namespace {

namespace fs = std::filesystem;

class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / fmt::format("krok-targets-{}", getpid())) {
    fs::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

const fs::path& folder() {
  static const Folder made;
  return made.path();
}

template <auto read>
void judge_read(const std::string& path, const char* what) {
  const std::string written = content_of(path);
  const auto result = read(bytes_of(written));
  if (!result) fail(fmt::format("{} that does not read back: {}", what, result.error().message));
  if (const Status status = check(*result); !status) {
    fail(fmt::format("{} that does not hold: {}", what, status.error().message));
  }
}

}  // namespace

std::string scratch(const std::string& name) {
  return (folder() / name).string();
}

void clear_scratch() {
  for (const auto& entry : fs::directory_iterator(folder())) fs::remove_all(entry.path());
}

std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

bool run_tool(const cli::MakeToolSpec& make_spec, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "tool");
  arguments.insert(arguments.end(), {"--jobs=1", "--quiet", "--progress=none"});
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  begin_memory_watch();
  const int code = cli::run_tool(make_spec, static_cast<int>(argv.size()), argv.data());
  std::int64_t files = 0;
  for (const auto& entry : fs::directory_iterator(folder())) {
    files += static_cast<std::int64_t>(entry.file_size());
  }
  if (peak_memory() > 4 * files + (std::int64_t{64} << 20)) {
    fail(fmt::format("{} MiB for files of {} bytes: {}", peak_memory() >> 20, files,
                     fmt::join(arguments, " ")));
  }
  if (code != cli::kExitDone && code != cli::kExitNo && code != cli::kExitTrouble) {
    fail(fmt::format("exit code {}", code));
  }
  return code != cli::kExitTrouble;
}

void judge_report(const std::string& path) {
  if (!nlohmann::json::accept(content_of(path))) fail("a report that is not JSON");
}

Result<Clip> read_stretched(std::span<const std::byte> file) {
  Stretches stretches;
  return anim::read(file, &stretches);
}

void judge_motion(const std::string& path) {
  judge_read<read_stretched>(path, "a motion");
}

void judge_model(const std::string& path) {
  judge_read<model::read>(path, "a model");
}

void judge_gltf(const std::string& path) {
  const std::string written = content_of(path);
  const auto back = gltf::read(bytes_of(written));
  if (!back) fail("glTF that does not read back: " + back.error().message);
}

void judge_table(const std::string& path) {
  const std::string text = content_of(path);
  const auto table = csv::Table::read(text, "out.csv");
  if (!table) return;  // without frames, a header alone
  for (std::size_t c = 0; c < table->columns().size(); ++c) {
    if (table->numeric()[c] == 0) continue;
    const std::size_t columns[] = {c};
    const auto numbers = table->numbers(columns);
    if (!numbers) fail("a table that does not read back: " + numbers.error().message);
    if (!std::ranges::all_of(numbers->front(), [](double x) { return std::isfinite(x); })) {
      fail("a table with numbers that are not finite");
    }
  }
}

void judge_chart(const std::string& path) {
  const std::string drawn = content_of(path);
  for (const char* wrong :
       {"\"nan", "\"inf", "\"-inf", " nan", " inf", ",nan", ",inf", ">inf", ">nan"}) {
    if (drawn.find(wrong) != std::string::npos) fail("a chart with numbers that are not finite");
  }
}

}  // namespace krok::guided
