#include "formats/acclaim/acclaim_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "core/file.h"
#include "core/text.h"

namespace krok::acclaim {

namespace {

namespace fs = std::filesystem;

// Whether the motion's name begins with the skeleton's name as a complete word: not 1.asf for
// 11_01.amc.
bool begins_name(const std::string& skeleton, const std::string& motion) {
  if (skeleton.empty() || !same_word(motion.substr(0, skeleton.size()), skeleton)) return false;
  if (motion.size() == skeleton.size()) return true;
  const char next = motion[skeleton.size()];
  return next == '_' || next == '-' || next == '.' || next == ' ';
}

// Sorted, independent of the directory order.
std::vector<fs::path> skeletons_in(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code ignored;
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end;
       entry.increment(ignored)) {
    if (extension(entry->path().string()) == ".asf") found.push_back(entry->path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

Result<FoundSkeleton> find_skeleton(const std::string& amc_path) {
  const fs::path motion(amc_path);
  const fs::path folder = motion.has_parent_path() ? motion.parent_path() : fs::path(".");
  const std::vector<fs::path> skeletons = skeletons_in(folder);
  const std::string motion_stem = motion.stem().string();
  std::size_t longest = 0;
  std::vector<fs::path> named;
  for (const fs::path& skeleton : skeletons) {
    const std::string stem = skeleton.stem().string();
    if (!begins_name(stem, motion_stem) || stem.size() < longest) continue;
    if (stem.size() > longest) named.clear();
    longest = stem.size();
    named.push_back(skeleton);
  }
  // As on the command line: without "./".
  const auto beside = [&](const fs::path& skeleton) {
    return (motion.parent_path() / skeleton.filename()).string();
  };
  if (named.size() == 1)
    return FoundSkeleton{beside(named[0]), "the motion's name begins with its name", true};
  if (skeletons.size() == 1) {
    return FoundSkeleton{beside(skeletons[0]), "it is the only one in the motion's folder"};
  }
  return Error("acclaim-skeleton",
               skeletons.empty()
                   ? std::string("an AMC motion needs its skeleton, and there is no .asf file in "
                                 "its folder")
                   : fmt::format("an AMC motion needs its skeleton, and it is not clear which of "
                                 "the {} .asf files in its folder it is",
                                 skeletons.size()))
      .in_file(amc_path);
}

}  // namespace krok::acclaim
