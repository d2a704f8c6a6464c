#include "cli/made_once.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "support/this_build.h"

namespace krok::test {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Sizes and times of all files that a run depends on.
std::string state_of(const fs::path& tools, const fs::path& source) {
  std::map<std::string, std::string> files;
  for (const fs::path& folder : {tools, source}) {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (!entry.is_regular_file()) continue;
      files[entry.path().string()] =
          std::to_string(entry.file_size()) + " " +
          std::to_string(entry.last_write_time().time_since_epoch().count());
    }
  }
  return json(files).dump();
}

// Held by one process at a time.
class Lock {
 public:
  explicit Lock(const fs::path& file) : number_(::open(file.c_str(), O_RDWR | O_CREAT, 0644)) {
    if (number_ < 0 || flock(number_, LOCK_EX) != 0)
      throw std::runtime_error("no lock " + file.string());
  }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
  ~Lock() { ::close(number_); }

 private:
  int number_;
};

}  // namespace

Made made_once(const std::string& name, const fs::path& source,
               const std::function<ToolRun(const fs::path& folder)>& make) {
  const fs::path root = fs::path(reports_folder()).parent_path() / "made";
  fs::create_directories(root);
  Made made{root / name, {}};
  const fs::path record = root / (name + ".json");
  const Lock lock(root / (name + ".lock"));
  const std::string state = state_of(tools_folder(), source);
  if (std::ifstream in(record); in) {
    const json kept = json::parse(in);
    if (kept["state"] == state) {
      made.run.exit_code = kept["exit_code"];
      made.run.out = kept["out"];
      made.run.err = kept["err"];
      return made;
    }
  }
  fs::remove(record);
  fs::remove_all(made.folder);
  fs::create_directories(made.folder);
  made.run = make(made.folder);
  std::ofstream(record) << json{{"state", state},
                                {"exit_code", made.run.exit_code},
                                {"out", made.run.out},
                                {"err", made.run.err}};
  return made;
}

}  // namespace krok::test
