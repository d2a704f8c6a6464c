#include "tools/krok-diff/folders.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iterator>
#include <set>

#include "core/hash.h"
#include "core/in_order.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "core/text.h"
#include "formats/registry/registry.h"
#include "tools/cli/paths.h"
#include "tools/krok-diff/compare_files.h"

namespace krok::cli::diff {

namespace {

namespace fs = std::filesystem;

// How many files may be compared ahead of the first one not yet reported.
constexpr std::size_t kWindow = 64;
constexpr std::size_t kMaxPictures = 200;

// One pair, and its messages.
struct Compared {
  FileResult result;
  Diagnostics issues;
  std::vector<Report::Input> inputs;
};

bool is_gltf_text(const std::string& path, const InputFile& file) {
  return registry::identify(path, file.bytes()) == registry::Kind::gltf;
}

// The difference of two files compared byte by byte.
Outcome byte_outcome(const InputFile& first, const InputFile& second) {
  const auto a = first.bytes(), b = second.bytes();
  const auto apart = std::mismatch(a.begin(), a.end(), b.begin(), b.end()).first - a.begin();
  Outcome outcome;
  outcome.kind = "bytes";
  outcome.summary = {"compared byte by byte"};
  std::string sentence = fmt::format("first difference at byte {}", grouped(apart));
  if (a.size() != b.size()) {
    sentence = fmt::format("{} in the first, {} in the second; {}", counted(a.size(), "byte"),
                           counted(b.size(), "byte"), sentence);
  }
  outcome.structure = {sentence};
  return outcome;
}

class Comparison {
 public:
  Comparison(const Options& options, ToolContext& context) : options_(options), context_(context) {}

  Result<FolderOutcome> run() {
    if (Status status = list(); !status) return status.error();
    // Files that a glTF refers to are compared with it, so glTF files come first.
    std::vector<std::size_t> gltf, others;
    for (std::size_t i = 0; i < outcome_.files.size(); ++i) {
      if (outcome_.files[i].status != FileStatus::not_compared) continue;
      (extension(outcome_.files[i].path) == ".gltf" ? gltf : others).push_back(i);
    }
    context_.progress->begin("comparing files", gltf.size() + others.size());
    compare(gltf);
    others.erase(std::remove_if(others.begin(), others.end(),
                                [&](std::size_t i) {
                                  if (stopped_ || !is_part(outcome_.files[i].path)) return false;
                                  outcome_.files[i].status = FileStatus::same;
                                  context_.progress->advance(1);
                                  return true;
                                }),
                 others.end());
    compare(others);
    context_.progress->end();
    return std::move(outcome_);
  }

 private:
  std::string first_path(const std::string& path) const { return below(options_.first, path); }
  std::string second_path(const std::string& path) const { return below(options_.second, path); }

  Status list() {
    const PathFilter& filter = options_.folders.filter;
    FolderFiles first, second;
    std::error_code unknown;
    // With --update, the first folder need not exist.
    const bool begun = !options_.folders.update || fs::exists(options_.first, unknown);
    if (begun) {
      auto found = files_in(options_.first, filter, options_.second, context_.destinations);
      if (!found) return found.error();
      first = std::move(*found);
    }
    auto found = files_in(options_.second, filter, options_.first, context_.destinations);
    if (!found) return found.error();
    second = std::move(*found);
    if (first.paths.empty() && second.paths.empty()) {
      return Error(
          "diff-empty",
          fmt::format("neither {} nor {} has files to compare", options_.first, options_.second),
          filter.include.empty() && filter.exclude.empty() ? "check that the files were written"
                                                           : "check --include and --exclude");
    }
    outcome_.notes = std::move(first.notes);
    std::move(second.notes.begin(), second.notes.end(), std::back_inserter(outcome_.notes));
    for (const std::string& pattern : filter.exclude) {
      const PathFilter excluded{{pattern}, {}};
      for (const std::string& folder : {options_.first, options_.second}) {
        found = files_in(folder, excluded, {}, {});
        if (found && !found->paths.empty()) break;
      }
      if (!found || found->paths.empty()) {
        context_.diagnose(make_warning(
            "diff-pattern", fmt::format("--exclude '{}' matches no file", shown(pattern)),
            "* and ? are within a name, ** is any number of folders"));
      }
    }
    pair(first.paths, second.paths);
    return {};
  }

  void pair(const std::vector<std::string>& first, const std::vector<std::string>& second) {
    auto a = first.begin();
    auto b = second.begin();
    while (a != first.end() || b != second.end()) {
      FileResult& file = outcome_.files.emplace_back();
      if (b == second.end() || (a != first.end() && *a < *b)) {
        file.path = *a++;
        file.status = FileStatus::only_in_first;
      } else if (a == first.end() || *b < *a) {
        file.path = *b++;
        file.status = FileStatus::only_in_second;
      } else {
        file.path = *a++;
        ++b;
      }
    }
  }

  // Whether both files of this name were read as parts of others.
  bool is_part(const std::string& path) const {
    return parts_.count(place_of(first_path(path))) > 0 &&
           parts_.count(place_of(second_path(path))) > 0;
  }

  void compare(const std::vector<std::size_t>& chosen) {
    if (stopped_) return;
    const int threads = thread_count(context_.jobs);
    const int workers = static_cast<int>(
        std::clamp<std::size_t>(chosen.size(), 1, static_cast<std::size_t>(threads)));
    jobs_of_a_file_ = std::max(1, threads / workers);
    in_order<Compared>(
        chosen.size(), workers, kWindow,
        [&](std::size_t i) { return compare_pair(outcome_.files[chosen[i]].path); },
        [&](std::size_t i, Compared compared) {
          return take(outcome_.files[chosen[i]], std::move(compared));
        });
  }

  bool take(FileResult& file, Compared compared) {
    context_.progress->advance(1);
    context_.diagnose(compared.issues);
    for (std::size_t i = 0; i < compared.inputs.size(); ++i) {
      Report::Input& input = compared.inputs[i];
      if (input.path != first_path(file.path) && input.path != second_path(file.path)) {
        parts_.insert(place_of(input.path));
      }
      context_.report.inputs.push_back(std::move(input));
    }
    file = std::move(compared.result);
    keep_worst_pictures(file);
    if (file.status == FileStatus::unreadable && !options_.folders.keep_going) stopped_ = true;
    return !stopped_;
  }

  // Keeps the pictures of the worst kMaxPictures files, so that a page can be opened whatever the
  // number of files.
  void keep_worst_pictures(FileResult& file) {
    if (!file.detail.pictures) return;
    shown_.emplace(file.detail.excess, &file);
    if (shown_.size() <= kMaxPictures) return;
    FileDetail& least = shown_.begin()->second->detail;
    least.pictures.reset();
    least.chart.clear();
    shown_.erase(shown_.begin());
  }

  // Called from several threads.
  Compared compare_pair(const std::string& path) const {
    Compared compared;
    compared.result.path = path;
    Options one = options_;
    one.first = first_path(path);
    one.second = second_path(path);
    one.folders = {};
    OneOfMany messages;
    ToolContext context = context_.beside(messages, jobs_of_a_file_);
    const auto begin = std::chrono::steady_clock::now();
    auto outcome = outcome_of(one, context);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
    compared.result.seconds = taken.count();
    if (!outcome) {
      Error error = outcome.error();
      if (error.where.file.empty()) error.where.file = one.second;
      compared.result.status = FileStatus::unreadable;
      compared.result.what = fmt::format("{} [{}]", error.message, error.code);
      context.report.issues.push_back(std::move(error));
    } else if (outcome->same) {
      compared.result.status = FileStatus::same;
    } else {
      compared.result.status = FileStatus::differs;
      compared.result.what = worst_of(*outcome);
      if (!options_.summaries.empty()) {
        compared.result.detail = detail_of(*outcome, options_.tolerance);
      }
      if (!context_.report_path.empty()) {
        // Omit the per-joint and per-mesh tables, which would make reports of thousands of files
        // too large.
        outcome->meshes.clear();
        outcome->joints.clear();
        compared.result.outcome = to_json(*outcome, options_.tolerance);
      }
    }
    for (Diagnostic& issue : context.report.issues) {
      if (issue.where.file.empty()) issue.where.file = one.second;
    }
    compared.issues = std::move(context.report.issues);
    compared.inputs = std::move(context.report.inputs);
    return compared;
  }

  // Identical files are the same without parsing, except .gltf, which refers to other files. File
  // types that cannot be compared are compared byte by byte.
  static Result<Outcome> outcome_of(const Options& one, ToolContext& context) {
    const auto first = InputFile::open(one.first);
    if (!first) return first.error();
    const auto second = InputFile::open(one.second);
    if (!second) return second.error();
    const auto a = first->bytes(), b = second->bytes();
    const bool equal = std::equal(a.begin(), a.end(), b.begin(), b.end());
    const auto note_inputs = [&] {
      context.report.inputs.clear();
      for (const InputFile* file : {&*first, &*second}) {
        context.report.inputs.push_back({file->path(), hex(file->checksum())});
      }
    };
    if (equal && !is_gltf_text(one.first, *first)) {
      note_inputs();
      Outcome outcome;
      outcome.same = true;
      return outcome;
    }
    auto outcome = compare_files(one, context);
    if (outcome) return outcome;
    if (outcome.error().code == "diff-kind") {
      note_inputs();
      return byte_outcome(*first, *second);
    }
    if (outcome.error().code == "diff-kinds") {
      Outcome other;
      other.structure = {outcome.error().message};
      return other;
    }
    return outcome;
  }

  const Options& options_;
  ToolContext& context_;
  FolderOutcome outcome_;
  std::set<std::string> parts_;
  std::set<std::pair<double, FileResult*>> shown_;  // files with pictures
  int jobs_of_a_file_ = 1;
  bool stopped_ = false;
};

// The final error if files could not be read.
Error unreadable_error(const FolderOutcome& outcome, const FolderOptions& options) {
  constexpr std::size_t kNamed = 10;
  std::string names;
  std::size_t named = 0;
  const std::size_t all = outcome.count(FileStatus::unreadable);
  for (const FileResult& file : outcome.files) {
    if (file.status != FileStatus::unreadable || named == kNamed) continue;
    names += (named++ == 0 ? "" : ", ") + file.path;
  }
  if (all > named) names += fmt::format(" and {} more", all - named);
  const std::string end = options.update ? "; nothing was updated" : "";
  if (!options.keep_going) {
    return Error("batch-stopped",
                 fmt::format("stopped at {}: the file cannot be read; {} not compared{}", names,
                             outcome.count(FileStatus::not_compared), end),
                 "use --keep-going to compare the others");
  }
  return Error("batch-failed",
               fmt::format("{} cannot be read: {}{}", counted(all, "file"), names, end));
}

// Runs the update and prints its results.
Result<FolderUpdate> run_update(const Options& options, const FolderOutcome& outcome,
                                ToolContext& context) {
  auto update = update_first(options, outcome, context);
  if (!update) return update;
  if (context.quiet) return update;
  const auto report_list = [&](const char* what, const std::vector<std::string>& paths) {
    for (const std::string& path : paths) {
      context.log(fmt::format("{} {}", what, below(options.first, path)));
    }
  };
  report_list("replaced", update->replaced);
  report_list("added", update->added);
  report_list("removed", update->removed);
  return update;
}

}  // namespace

FileDetail detail_of(Outcome outcome, const compare::Tolerance& tolerance) {
  return {excess_of(outcome), to_text(outcome, tolerance), std::move(outcome.pictures),
          std::move(outcome.chart)};
}

std::size_t FolderOutcome::count(FileStatus status) const {
  return static_cast<std::size_t>(
      std::count_if(files.begin(), files.end(),
                    [status](const FileResult& file) { return file.status == status; }));
}

void declare_folder_options(CommandOptions& command, FolderOptions& options) {
  command.group("Folders");
  const auto patterns = [&](const char* name, std::vector<std::string>& list, const char* help) {
    command.add_option(name, list, help).one_each_time();
  };
  patterns("--include PATTERN", options.filter.include,
           "Compare only files that match, '*.glb' or 'walks/**/*.glb'; repeatable");
  patterns("--exclude PATTERN", options.filter.exclude, "Skip files that match; repeatable");
  command.add_flag("--keep-going", options.keep_going,
                   "Continue after a file that cannot be read, and exit with code 3; by default, "
                   "the first one ends the run");
  command.add_flag("--update", options.update,
                   "Copy changed and new files from B to A; no file is copied if any cannot be "
                   "read. A need not exist");
  command.add_flag("--prune", options.prune, "With --update: remove files that only A has")
      .only_with("--update");
}

Result<bool> are_folders(const Options& options) {
  std::error_code unknown;
  const bool first = fs::is_directory(options.first, unknown);
  const bool second = fs::is_directory(options.second, unknown);
  const bool first_to_come =
      options.folders.update && !fs::exists(fs::symlink_status(options.first, unknown));
  if (!first && !second) {
    if (!options.folders.any()) return false;
    if (first_to_come ||
        (fs::exists(options.first, unknown) && fs::exists(options.second, unknown))) {
      return Error("usage",
                   "--include, --exclude, --keep-going, --update and --prune are for folders",
                   "give two folders");
    }
    return false;  // a missing file is reported when it is opened
  }
  if (second && first_to_come) return true;
  if (first && second) return true;
  const std::string& folder = first ? options.first : options.second;
  const std::string& other = first ? options.second : options.first;
  if (!fs::exists(other, unknown)) {
    return Error("file-missing", "no such folder",
                 second ? "--update creates it, with the contents of the other" : "")
        .in_file(other);
  }
  return Error("diff-kinds", fmt::format("{} is a folder, but {} is not", folder, other),
               "give two folders or two files");
}

Result<int> run_folders(const Options& options, ToolContext& context) {
  if (!options.sheet.path.empty() || !options.plot.empty() || !options.heatmap.empty()) {
    return Error("usage", "--sheet, --plot and --heatmap are for two files, not folders",
                 "use --summary for folders");
  }
  const FolderOptions& folders = options.folders;
  const auto outcome = Comparison(options, context).run();
  if (!outcome) return outcome.error();
  const auto some = [&](FileStatus status) { return outcome->count(status) > 0; };
  const bool failed = some(FileStatus::unreadable);
  context.report.result = to_json(*outcome, options);
  if (!context.quiet) context.print(to_text(*outcome, options, context.verbose));
  if (failed && !folders.keep_going) {
    // A page of an earlier run, left as it is, would say that all is well.
    if (Status status = write_summary(*outcome, {}, options, context); !status) {
      return status.error();
    }
    context.diagnose(unreadable_error(*outcome, folders));
    return kExitTrouble;
  }

  FolderUpdate update;
  if (folders.update && !failed) {
    auto done = run_update(options, *outcome, context);
    if (!done) return done.error();
    update = std::move(*done);
    context.report.result["update"] = {
        {"replaced", update.replaced}, {"added", update.added}, {"removed", update.removed}};
  }
  if (Status status = write_summary(*outcome, update, options, context); !status) {
    return status.error();
  }
  if (failed) {
    context.diagnose(unreadable_error(*outcome, folders));
    return kExitPartly;
  }
  const bool missing = some(FileStatus::only_in_first) && !(folders.update && folders.prune);
  const bool other = some(FileStatus::differs) || some(FileStatus::only_in_second);
  return missing || (other && !folders.update) ? kExitNo : kExitDone;
}

}  // namespace krok::cli::diff
