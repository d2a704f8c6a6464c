#include "tools/batch/list.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <unordered_set>

#include "core/file.h"
#include "core/glob.h"
#include "core/hash.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/io/open_scene.h"
#include "tools/cli/option_kinds.h"
#include "tools/cli/paths.h"
#include "tools/cli/usage.h"

namespace krok::cli::batch {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxErrors = 20;

// An input, and the base folder of the sub-folders to keep; not known yet for files named
// individually.
struct Found {
  std::string input;
  std::optional<std::string> base;
};

struct Shard {
  std::int64_t index = 1, count = 1;
};

Result<Shard> parse_shard(const std::string& text) {
  if (text.empty()) return Shard();
  const std::size_t slash = text.find('/');
  if (slash != std::string::npos) {
    const auto index = parse_integer(text.substr(0, slash));
    const auto count = parse_integer(text.substr(slash + 1));
    if (index && count && *index >= 1 && *index <= *count && *count <= 1'000'000) {
      return Shard{*index, *count};
    }
  }
  return Error("usage", fmt::format("--shard: '{}' is not of the form I/N", text),
               "for four parts, use 1/4, 2/4, 3/4 and 4/4");
}

// The longest common folder of absolute paths.
std::string common_folder(const std::vector<std::string>& paths) {
  std::optional<fs::path> common;
  for (const std::string& path : paths) {
    const fs::path folder = fs::path(path).parent_path();
    if (!common) {
      common = folder;
      continue;
    }
    fs::path shared;
    for (auto a = common->begin(), b = folder.begin();
         a != common->end() && b != folder.end() && *a == *b; ++a, ++b) {
      shared /= *a;
    }
    common = shared;
  }
  return common ? common->string() : std::string();
}

class Lister {
 public:
  Lister(const CommandLine& line, const MakeToolSpec& make_spec, Diagnostics& errors)
      : line_(line), spec_(make_spec()), sets_(make_spec, line), errors_(errors) {}

  BatchList list() {
    const auto shard = parse_shard(line_.shard);
    if (!shard) fail(shard.error());
    if (line_.manifest.empty()) {
      from_arguments();
    } else {
      from_manifest();
    }
    if (errors_.empty()) name_outputs();
    list_.total = list_.files.size();
    list_.option_sets = std::move(sets_).take();
    if (errors_.empty()) check_batch(line_, list_, errors_);
    if (errors_.size() > kMaxErrors) shorten_errors();
    if (!errors_.empty()) return {};
    // By name, so that a file stays in its shard when other files are added or removed.
    std::erase_if(list_.files, [&](const BatchFile& file) {
      const auto hash = xxh3(std::as_bytes(std::span(file.key)));
      return hash % static_cast<std::uint64_t>(shard->count) !=
             static_cast<std::uint64_t>(shard->index - 1);
    });
    return std::move(list_);
  }

 private:
  void fail(Error error) { errors_.push_back(std::move(error)); }

  void shorten_errors() {
    const std::size_t more = errors_.size() - kMaxErrors;
    errors_.resize(kMaxErrors);
    fail(Error("usage", fmt::format("and {} more", more)));
  }

  void from_arguments() {
    const auto set = sets_.find({});
    if (!set) return fail(set.error());
    const auto& ending = sets_.all()[*set].ending;
    if (!ending) return fail(ending.error());
    std::error_code unknown;
    if (extension(line_.out_dir) == *ending && !fs::exists(line_.out_dir, unknown)) {
      return fail(usage(fmt::format("--out-dir is for a folder, not {}", shown(line_.out_dir)),
                        fmt::format("-o {} writes one file, --out-dir DIR one for each input",
                                    shown(line_.out_dir))));
    }
    if (line_.inputs.empty()) {
      return fail(Error("usage", "no input given", "give files, folders or patterns"));
    }
    std::unordered_set<std::string> known;
    for (const std::string& argument : line_.inputs) {
      for (const Found& found : find(argument)) {
        std::vector<std::string> inputs = {found.input};
        if (sets_.all()[*set].each_animation) {
          inputs = io::addresses_in(inputs[0], line_.limits(), list_.left_out);
        }
        for (std::string& input : inputs) {
          std::string absolute = absolute_path(input);
          if (!known.insert(absolute).second) continue;
          absolute_.push_back(std::move(absolute));
          list_.files.push_back({std::move(input), {}, {}, {}, *set, {}, found.base.has_value()});
          bases_.push_back(found.base);
        }
      }
    }
  }

  std::vector<Found> find(const std::string& argument) {
    if (argument == "-") {
      fail(Error("usage", "standard input cannot be used in batch mode", "use -o, or give files"));
      return {};
    }
    std::error_code missing;
    Result<std::vector<std::string>> paths = std::vector<std::string>();
    std::string base = argument;
    std::string nothing;
    if (fs::is_directory(argument, missing)) {
      paths = find_files_below(argument);
      if (paths) {
        leave_out_results(argument, *paths);
        const Diagnostics others = keep_inputs(argument, spec_.batch->reads, *paths);
        list_.left_out.insert(list_.left_out.end(), others.begin(), others.end());
      }
      nothing = fmt::format("the folder has no {} file", either_of(spec_.batch->reads));
    } else if (has_wildcards(argument) && !fs::exists(argument, missing)) {
      paths = find_files(argument);
      base = fixed_part(argument);
      if (paths) leave_out_results(base, *paths);
      nothing = "no file matches this pattern";
    } else if (fs::exists(io::address_of(argument).file, missing)) {
      return {{argument, std::nullopt}};
    } else {
      const bool may_be_result = line_.inputs.size() == 2 && argument == line_.inputs.back();
      fail(Error("file-missing", "no such file",
                 may_be_result ? "check the path; a file to be written is given with -o"
                               : missing_file_hint(argument))
               .in_file(argument));
      return {};
    }
    std::vector<Found> found;
    if (!paths) {
      fail(paths.error());
    } else if (paths->empty()) {
      fail(Error("usage", nothing).in_file(argument));
    } else {
      for (std::string& path : *paths) found.push_back({std::move(path), base});
    }
    return found;
  }

  // If the output folder is inside the input folder, outputs must not become inputs.
  void leave_out_results(const std::string& folder, std::vector<std::string>& paths) const {
    std::error_code unknown;
    const fs::path read = fs::weakly_canonical(folder.empty() ? "." : folder, unknown);
    const fs::path written = fs::weakly_canonical(line_.out_dir.empty() ? "." : line_.out_dir);
    const fs::path inside = written.lexically_relative(read);
    if (inside.empty() || inside == "." || *inside.begin() == "..") return;
    const std::string results = absolute_path((fs::path(folder) / inside).string()) + "/";
    std::erase_if(
        paths, [&](const std::string& path) { return absolute_path(path).rfind(results, 0) == 0; });
  }

  // With --keep-going a missing file fails when its turn comes.
  void check_exists(const ManifestWord& input) {
    std::error_code missing;
    if (line_.keep_going || input.text == "-" ||
        fs::exists(io::address_of(input.text).file, missing)) {
      return;
    }
    const bool blanks = input.text.find_first_of(" ,;") != std::string::npos;
    Error error("file-missing", fmt::format("no such file: {}", shown(input.text)),
                blanks ? "separate input, output and options by tabs, not blanks or commas"
                       : "check the path, or convert the other files with --keep-going");
    error.where = input.where;
    error.where.file = line_.manifest;
    fail(std::move(error));
  }

  void from_manifest() {
    if (!line_.inputs.empty()) {
      return fail(Error("usage", "inputs cannot be combined with --manifest", "use one of them"));
    }
    const auto file = InputFile::open(line_.manifest);
    if (!file) return fail(file.error());
    Manifest manifest = parse_manifest(file->text(), line_.manifest);
    errors_.insert(errors_.end(), manifest.errors.begin(), manifest.errors.end());
    for (ManifestLine& line : manifest.lines) {
      check_exists(line.input);
      const auto set = sets_.find(line.options);
      if (!set) {
        fail(Error(set.error()).in_file(line_.manifest));
        if (line.options.empty()) return;  // the command line itself is invalid
        continue;
      }
      // Location of the options, for messages.
      const Location place = line.options.empty() ? line.input.where : line.options[0].where;
      if (line.output.text.empty() && line_.out_dir.empty()) {
        fail(Error("manifest-line", "no output given", "add an output, or use --out-dir")
                 .in_file(line_.manifest)
                 .at_line(place.line, line.input.where.column));
        continue;
      }
      absolute_.push_back(absolute_path(line.input.text));
      list_.files.push_back({line.input.text, {}, line.output.text, {}, *set, place});
      bases_.push_back(std::nullopt);
    }
    std::stable_sort(errors_.begin(), errors_.end(),
                     [](const auto& a, const auto& b) { return a.where.line < b.where.line; });
    if (manifest.lines.empty() && errors_.empty()) {
      fail(Error("manifest-line", "the list has no files").in_file(line_.manifest));
    }
  }

  // Fills in missing keys and output paths.
  void name_outputs() {
    std::vector<std::string> named;  // individually
    for (std::size_t i = 0; i < list_.files.size(); ++i) {
      if (list_.files[i].key.empty() && !bases_[i]) named.push_back(absolute_[i]);
    }
    const std::string common = common_folder(named);
    for (std::size_t i = 0; i < list_.files.size(); ++i) {
      BatchFile& file = list_.files[i];
      if (file.key.empty()) {
        const std::string& base = !line_.base.empty() ? line_.base
                                  : bases_[i]         ? *bases_[i]
                                                      : common;
        name_output(file, absolute_[i], base);
      } else {
        file.key = fs::path(file.key).lexically_normal().string();
        file.name = fs::path(file.key).replace_extension().string();
      }
      file.output = below(line_.out_dir, file.key);
    }
  }

  // Absolute path of a base, with a trailing slash. Cached: consecutive files often share a base.
  const std::string& folder_of(const std::string& base) {
    if (folder_.empty() || base != base_of_folder_) {
      base_of_folder_ = base;
      folder_ = absolute_path(base.empty() ? "." : base);
      if (!folder_.ends_with('/')) folder_ += '/';
    }
    return folder_;
  }

  void name_output(BatchFile& file, const std::string& absolute, const std::string& base) {
    const std::string& folder = folder_of(base);
    if (!absolute.starts_with(folder) || absolute.size() == folder.size()) {
      return fail(Error("usage", fmt::format("is not inside {}", base),
                        "--base must be a folder that contains all inputs")
                      .in_file(file.input));
    }
    const auto& ending = sets_.all()[file.options].ending;
    if (!ending) {
      Error error = ending.error();
      error.where = file.line;
      return fail(std::move(error));
    }
    file.name = path_without_ending(absolute).substr(folder.size());
    file.key = file.name + *ending;
  }

  const CommandLine& line_;
  const ToolSpec spec_;
  OptionSets sets_;
  Diagnostics& errors_;
  BatchList list_;
  std::vector<std::string> absolute_;              // the input of each file
  std::vector<std::optional<std::string>> bases_;  // of each file
  std::string base_of_folder_, folder_;            // last call of folder_of()
};

}  // namespace

std::string expanded(const std::string& value, const BatchFile& file, const std::string& out_dir) {
  const std::string placeholder = "{name}";
  std::string path = value;
  for (std::size_t at = 0; (at = path.find(placeholder, at)) != std::string::npos;) {
    path.replace(at, placeholder.size(), file.name);
    at += file.name.size();
  }
  return below(out_dir, path);
}

std::vector<GivenOption> options_of(const BatchFile& file, const BatchList& list,
                                    const std::string& out_dir) {
  std::vector<GivenOption> options = list.option_sets[file.options].options;
  for (GivenOption& option : options) {
    if (!option.names_output) continue;
    for (std::string& value : option.values) value = expanded(value, file, out_dir);
  }
  return options;
}

BatchList list_files(const CommandLine& line, const MakeToolSpec& make_spec, Diagnostics& errors) {
  return Lister(line, make_spec, errors).list();
}

}  // namespace krok::cli::batch
