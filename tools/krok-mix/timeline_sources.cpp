#include "tools/krok-mix/timeline_sources.h"

#include <filesystem>
#include <set>

#include "formats/io/open_motion.h"
#include "formats/io/open_role_map.h"
#include "formats/sequences/sequences.h"

namespace krok::cli::mix {

namespace {

std::string beside(const std::string& path, const std::string& name) {
  if (path == "-") return name;
  return (std::filesystem::path(path).parent_path() / name).string();
}

Result<std::vector<timeline::Part>> read_parts(const std::string& path, double rate,
                                               ToolContext& context) {
  const auto file = context.open_input(path);
  if (!file) return file.error();
  const auto named = sequences::read(file->text());
  if (!named) return Error(named.error()).in_file(path);
  std::vector<timeline::Part> parts;
  const double counted_at = named->rate > 0 ? named->rate : rate;
  for (const sequences::Sequence& sequence : named->sequences) {
    parts.push_back({sequence.name,
                     {sequence.first / counted_at, false},
                     {sequence.last / counted_at, false},
                     sequence.speed,
                     sequence.loop});
  }
  return parts;
}

}  // namespace

Result<TimelineSources> read_sources(const timeline_file::Document& document,
                                     const std::string& path, const Options& options,
                                     const io::FindRoles& find_roles, ToolContext& context) {
  std::set<int> in_base;
  for (const timeline::BaseItem& item : document.timeline.base) in_base.insert(item.play.source);
  TimelineSources read;
  for (std::size_t i = 0; i < document.sources.size(); ++i) {
    const timeline_file::SourceFile& source = document.sources[i];
    const std::string motion_path = beside(path, source.path);
    auto clip = io::open_motion(motion_path, context);
    if (!clip) return clip.error();
    auto& motion = read.motions.emplace_back();
    motion.clip = std::move(*clip);
    timeline::Source made{source.name, &motion.clip, nullptr, {}};
    if (in_base.contains(static_cast<int>(i))) {
      auto keys =
          choose_keys(options.keys, motion_path, source.name, motion.clip, find_roles, context);
      if (!keys) return keys.error();
      if (*keys) {
        motion.keys = std::move(**keys);
        made.keys = &motion.keys;
      }
    }
    if (!source.sequences.empty()) {
      auto parts = read_parts(beside(path, source.sequences), motion.clip.rate, context);
      if (!parts) return parts.error();
      made.parts = std::move(*parts);
    }
    read.sources.push_back(std::move(made));
  }
  return read;
}

}  // namespace krok::cli::mix
