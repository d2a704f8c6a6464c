#include "tools/batch/batch.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/file.h"
#include "core/hash.h"
#include "core/in_order.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "core/result.h"
#include "formats/io/open_motion.h"
#include "tools/batch/journal.h"
#include "tools/batch/list.h"
#include "tools/batch/option_sets.h"
#include "tools/cli/paths.h"
#include "tools/cli/report.h"

namespace krok::cli::batch {

namespace {

// Checksum for the journal of everything except the inputs' bytes that determines an output: tool,
// version, options, names of inputs and outputs. `context` is that of the file before it is
// processed; `fixed_positionals` are the inputs shared by all files.
std::string made_with(const BatchFile& file, const BatchList& list,
                      const std::vector<std::string>& fixed_positionals,
                      const ToolContext& context) {
  const std::vector<GivenOption>& options = list.option_sets[file.options].options;
  Json all = object_for(6);
  all["tool"] = context.report.tool;
  all["version"] = context.report.version;
  all["input"] = base_name(file.input);  // it is in the result's provenance
  all["options"] = context.result_options;
  // Other inputs by full path: the journal has checksums of their content under these paths.
  all["inputs"] = fixed_positionals;
  for (const GivenOption& option : options) {
    if (!option.names_input) continue;
    for (const std::string& value : option.values) all["inputs"].push_back(value);
  }
  all["outputs"] = Json::array();
  for (const GivenOption& option : options) {
    if (!option.names_output) continue;
    for (const std::string& value : option.values) {
      all["outputs"].push_back(expanded(value, file, ""));
    }
  }
  const std::string text = json_text(all);
  return hex(xxh3(std::as_bytes(std::span(text))));
}

// Assigns outputs whose names are not known from the list ("hero_{clip}.anim") to files of a batch.
class BatchNames {
 public:
  // The list must outlive this.
  BatchNames(const BatchList& list, std::string out_dir)
      : list_(list), out_dir_(std::move(out_dir)) {}

  // Fails (code usage) if `path` is an input of the batch or an output known from the list.
  // Thread-safe.
  Status check(const std::string& path);

  // Assigns the paths to the file `input`, all or none: fails (code usage) if another file has one
  // of them. Call in list order, so that the winner does not depend on -j.
  Status claim(const std::vector<std::string>& paths, const std::string& input);

 private:
  const BatchList& list_;
  std::string out_dir_;
  std::once_flag listed_once_;
  std::unordered_map<std::string, std::string> listed_;  // known canonical path -> input
  std::map<std::string, std::string> owners_;            // claimed path -> input
};

constexpr const char* kHint = "use a --manifest to name each output";

// The outputs of a file that are known from the list: its output, and those that options name.
std::vector<std::string> outputs_of(const BatchFile& file, const BatchList& list,
                                    const std::string& out_dir) {
  std::vector<std::string> paths = {file.output};
  for (const GivenOption& option : options_of(file, list, out_dir)) {
    if (option.names_output) paths.insert(paths.end(), option.values.begin(), option.values.end());
  }
  return paths;
}

Status BatchNames::check(const std::string& path) {
  if (const auto number = file_number(path)) {
    const auto read = list_.read_files.find(*number);
    if (read != list_.read_files.end()) return replaced_error(read->second);
  }
  std::call_once(listed_once_, [this] {
    for (const BatchFile& file : list_.files) {
      for (const std::string& output : outputs_of(file, list_, out_dir_)) {
        listed_[place_of(output)] = file.input;
      }
    }
  });
  const auto listed = listed_.find(place_of(path));
  if (listed == listed_.end()) return {};
  return Error("usage", fmt::format("{} would also be written by {}", path, listed->second), kHint);
}

Status BatchNames::claim(const std::vector<std::string>& paths, const std::string& input) {
  for (const std::string& path : paths) {
    const auto owner = owners_.find(place_of(path));
    if (owner == owners_.end()) continue;
    return Error("usage",
                 fmt::format("{} and {} would both be written to {}", owner->second, input, path),
                 kHint);
  }
  for (const std::string& path : paths) owners_[place_of(path)] = input;
  return {};
}

// The report of a batch as JSON (schema krok.batch/1), streamed while files are processed to bound
// memory:
//
//   {"schema", "tool", "version", "options",
//    "files": [{"input", "output", "status", "options", "inputs", "outputs", "issues", "result"}],
//    "issues": [], "result": {"files", "done", "unchanged", "failed", "left"}}
//
// One file per line, in list order for any number of threads; the status is done, unchanged or
// failed. The last "issues" are those of the batch as a whole, as in krok.report/1.
class BatchReport {
 public:
  // No report if `path` is empty.
  Status begin(const std::string& path, OutputFile::Options how, const std::string& tool,
               const std::string& version, const Json& options);
  bool is_wanted() const { return file_.has_value(); }
  void add(const Json& file);
  Status end(const Diagnostics& issues, const Json& result);

 private:
  std::optional<OutputFile> file_;
  bool first_ = true;
};

Status BatchReport::begin(const std::string& path, OutputFile::Options how, const std::string& tool,
                          const std::string& version, const Json& options) {
  if (path.empty()) return {};
  auto file = OutputFile::create(path, how);
  if (!file) return file.error();
  file_ = std::move(*file);
  return file_->write(
      fmt::format("{{\n  \"schema\": \"krok.batch/1\",\n  \"tool\": {},\n  \"version\": {},\n"
                  "  \"options\": {},\n  \"files\": [",
                  json_text(Json(tool)), json_text(Json(version)), json_text(options)));
}

// The file keeps write errors; end() returns them.
void BatchReport::add(const Json& file) {
  if (!file_) return;
  (void)file_->write((first_ ? "\n    " : ",\n    ") + json_text(rounded(file))).ok();
  first_ = false;
}

Status BatchReport::end(const Diagnostics& issues, const Json& result) {
  if (!file_) return {};
  const Status status = file_->write(fmt::format("{}],\n  \"issues\": {},\n  \"result\": {}\n}}\n",
                                                 first_ ? "" : "\n  ", json_text(to_json(issues)),
                                                 json_text(rounded(result))));
  const Status done = file_->commit();
  file_.reset();
  return status ? done : status;
}

namespace fs = std::filesystem;

// How many files may be processed ahead of the first whose messages are not printed yet.
constexpr std::size_t kWindow = 256;

// The outcome of one file.
struct Outcome {
  FileState state = FileState::failed;
  OneOfMany run;  // its held files are those to be renamed to their final names
  Json report;
  bool warned = false;
  Status journal;
  // Outputs whose names are not known from the list, "hero_{clip}.anim": if two files write the
  // same one, the first in list order gets it.
  std::vector<std::string> unforeseen;
  std::optional<Json> record;  // for the journal, after renaming
  ToolContext context;
};

Json options_of_batch(const CommandLine& line) {
  Json options = line.context().report.options;
  const auto note = [&](const char* name, const std::string& value) {
    if (!value.empty()) options[name] = value;
  };
  note("out-dir", line.out_dir);
  note("base", line.base);
  note("manifest", line.manifest);
  note("shard", line.shard);
  if (line.keep_going) options["keep-going"] = true;
  if (line.force) options["force"] = true;
  return options;
}

std::string journal_suffix(const std::string& shard) {
  if (shard.empty()) return {};
  const std::size_t slash = shard.find('/');
  return "." + shard.substr(0, slash) + "-of-" + shard.substr(slash + 1);
}

class Batch {
 public:
  Batch(const MakeToolSpec& make_spec, const CommandLine& line)
      : make_spec_(make_spec), line_(line), context_(line.context()) {
    const bool silent = line.quiet && line.style == ProgressStyle::automatic;
    console_ = console_progress(silent ? ProgressStyle::none : line.style);
    context_.console = console_.get();
  }

  int run() {
    if (!line_.output.empty()) {
      return stop({Error("usage", "-o is for one output, but there are several inputs",
                         "use --out-dir DIR")});
    }
    Diagnostics errors;
    list_ = list_files(line_, make_spec_, errors);
    tally_ = BatchTally(list_.files.size());
    if (!errors.empty()) return stop(errors);
    context_.diagnose(list_.left_out);
    if (Status status = prepare(); !status) return stop({status.error()});
    if (Status status = begin_report(); !status) return stop({status.error()});
    do_files();
    return finish();
  }

 private:
  Status begin_report() {
    return report_.begin(line_.json_path, {.no_clobber = line_.no_clobber}, context_.report.tool,
                         context_.report.version, options_of_batch(line_));
  }

  // Ends a batch before any file is started.
  int stop(const Diagnostics& errors) {
    context_.diagnose(errors);
    if (only_a_report_stands_at(line_.json_path) && begin_report()) {
      (void)report_.end(context_.report.issues, tally_.result()).ok();
    }
    return kExitTrouble;
  }

  // Creates folders and removes temporary files of killed runs.
  Status prepare() {
    std::set<std::string> folders = {line_.out_dir,
                                     fs::path(line_.json_path).parent_path().string()};
    for (const BatchFile& file : list_.files) {
      for (const std::string& path : outputs_of(file, list_, line_.out_dir)) {
        folders.insert(fs::path(path).parent_path().string());
      }
    }
    std::error_code trouble;
    if (!line_.out_dir.empty()) fs::create_directories(line_.out_dir, trouble);
    if (trouble) {
      return Error("file-unwritable", fmt::format("cannot create folder: {}", trouble.message()))
          .in_file(line_.out_dir);
    }
    for (const std::string& folder : folders) {
      remove_temporaries_of_killed(folder.empty() ? "." : folder);
    }
    journal_.emplace(line_.out_dir, context_.report.tool, journal_suffix(line_.shard));
    return {};
  }

  void do_files() {
    const std::size_t count = list_.files.size();
    std::vector<std::string> inputs;
    for (const auto& [number, path] : list_.read_files) inputs.push_back(path);
    takes_.emplace(std::move(inputs));
    const int threads = thread_count(line_.jobs);
    const int workers =
        static_cast<int>(std::clamp<std::size_t>(count, 1, static_cast<std::size_t>(threads)));
    jobs_of_a_file_ = std::max(1, threads / workers);
    ready_lines_.emplace(make_spec_, workers);
    console_->begin(context_.report.tool, count);
    in_order<Outcome>(
        count, workers, kWindow, [&](std::size_t i) { return do_file(list_.files[i]); },
        [&](std::size_t i, Outcome outcome) { return take(list_.files[i], std::move(outcome)); });
    console_->end();
  }

  Outcome do_file(const BatchFile& file) {
    Outcome outcome;
    try {
      run_file(file, outcome.context, outcome);
    } catch (const std::bad_alloc&) {
      fail(file, Error("out-of-memory", "out of memory"), outcome);
    } catch (const std::exception& error) {
      fail(file, Error("internal", error.what()), outcome);
    }
    outcome.warned = std::ranges::any_of(outcome.context.report.issues, [](const Diagnostic& one) {
      return one.severity == Severity::warning;
    });
    // Free data that no report needs on the thread that allocated it, which is cheaper.
    if (!report_.is_wanted()) outcome.context.report.issues = {};
    return outcome;
  }

  void run_file(const BatchFile& file, ToolContext& context, Outcome& outcome) {
    auto line = ready_lines_->take(file.options);
    const auto parsed = line->parse(arguments_for_file(options_of(file, list_, line_.out_dir),
                                                       line_.fixed_positionals, file.input,
                                                       file.output, line_.no_clobber));
    if (!parsed) return fail(file, parsed.error(), outcome);
    context = line->context();
    context.jobs = jobs_of_a_file_;
    context.limits = line_.limits();
    context.quiet = line_.quiet;
    context.verbose = line_.verbose;
    context.progress = &no_progress_;
    context.one_of_many = &outcome.run;
    context.takes = &*takes_;
    context.report_on_standard_output = line_.json_path == "-";
    context.subject.file = file.input;
    context.report_path = line_.json_path;
    outcome.run.check_unforeseen = [this](const std::string& path) { return names_.check(path); };

    const std::string digest = made_with(file, list_, line_.fixed_positionals, context);
    if (!line_.force) {
      if (auto record = journal_->unchanged(file.key, digest, io::address_of(file.input).file)) {
        return note_unchanged(file, std::move(*record), outcome);
      }
    }
    std::error_code known_later;  // noticed when the file is created
    for (const std::string& path : context.destinations) {
      fs::create_directories(fs::path(path).parent_path(), known_later);
    }
    const Result<int> done = run_guarded(line->spec(), context);
    ready_lines_->put_back(file.options, std::move(line));
    if (!done && file.found && done.error().code == "motion-missing") {
      Error error = done.error();
      error.severity = Severity::warning;
      error.message += ": it is left out";
      fail(file, std::move(error), outcome, FileState::left_out);
      return;
    }
    if (!done) return fail(file, done.error(), outcome);
    if (*done != kExitDone) {
      return fail(file, Error("failed", fmt::format("ended with exit code {}", *done)), outcome);
    }
    outcome.state = FileState::done;
    note_report(file, outcome);
    outcome.unforeseen = std::move(outcome.run.held_paths);
    auto record = journal_record(line_.out_dir, file.key, digest, io::address_of(file.input).file,
                                 context.report, places_of(outcome));
    // Outputs that are gone or not regular files cannot be checked by later runs.
    if (!record) return;
    if (outcome.run.held_files.empty()) {
      outcome.journal = journal_->add(*record);
    } else {
      outcome.record = std::move(*record);
    }
  }

  // Temporary names of outputs that are not renamed yet.
  static std::map<std::string, std::string> places_of(const Outcome& outcome) {
    std::map<std::string, std::string> places;
    for (std::size_t i = 0; i < outcome.run.held_files.size(); ++i) {
      places[outcome.unforeseen[i]] = outcome.run.held_files[i].written_at();
    }
    return places;
  }

  // In list order: renames held outputs to their final names.
  Status place(const BatchFile& file, Outcome& outcome) {
    if (Status status = names_.claim(outcome.unforeseen, file.input); !status) return status;
    if (Status status = OutputFile::place_all(outcome.run.held_files); !status) return status;
    if (outcome.record) outcome.journal = journal_->add(*outcome.record);
    return {};
  }

  // Adds a file to the batch report.
  void note_report(const BatchFile& file, Outcome& outcome) const {
    if (!report_.is_wanted()) return;
    const ToolContext& context = outcome.context;
    Json& report = outcome.report;
    report = object_for(8);
    report["input"] = file.input;
    report["output"] = file.output;
    report["status"] = name_of(outcome.state);
    report["options"] = context.report.options;
    report["inputs"] = to_json(context.report.inputs);
    report["outputs"] = context.report.outputs;
    report["issues"] = to_json(context.report.issues);
    report["result"] = context.report.result;
  }

  void note_unchanged(const BatchFile& file, Json record, Outcome& outcome) const {
    Report& report = outcome.context.report;
    outcome.state = FileState::unchanged;
    for (const Json& written : record["outputs"]) {
      report.outputs.push_back(below(line_.out_dir, written.value("path", std::string())));
      const std::string& path = report.outputs.back();
      if (!outcome.context.is_destination(path)) outcome.unforeseen.push_back(path);
    }
    note_report(file, outcome);
    if (!report_.is_wanted()) return;
    outcome.report["inputs"] = std::move(record["inputs"]);
    outcome.report["issues"] = std::move(record["issues"]);
    outcome.report["result"] = std::move(record["result"]);
  }

  void fail(const BatchFile& file, Error error, Outcome& outcome,
            FileState state = FileState::failed) const {
    ToolContext& context = outcome.context;
    // The location is a manifest word, or else the file.
    const bool of_line = error.code == "usage" && !list_.option_sets[file.options].options.empty();
    if (error.where.file.empty() && of_line && !file.line.file.empty()) error.where = file.line;
    context.report.tool = context_.report.tool;
    context.one_of_many = &outcome.run;
    context.subject.file = file.input;
    context.diagnose(error);
    outcome.state = state;
    outcome.run.held_files.clear();
    context.report.outputs.clear();
    context.report.result = Json::object();
    note_report(file, outcome);
  }

  // Reports the outcome of a file. Returns whether to continue.
  bool take(const BatchFile& file, Outcome outcome) {
    if (outcome.state != FileState::failed) {
      if (const Status status = place(file, outcome); !status) fail(file, status.error(), outcome);
    }
    std::string text;
    for (const OneOfMany::Message& message : outcome.run.messages) {
      if (messages_.is_shown(message.code, file.input)) text += message.text;
    }
    if (!text.empty()) write_message(console_.get(), text);
    if (report_.is_wanted()) report_.add(outcome.report);
    if (!outcome.journal && journal_trouble_) {
      journal_trouble_ = outcome.journal;
    }
    tally_.add(outcome.state, file.input, outcome.warned);
    console_->advance(1);
    if (outcome.state == FileState::done) {
      for (const std::string& path : outcome.context.report.outputs) {
        written_folders_.insert(fs::path(path).parent_path().string());
      }
    }
    return outcome.state != FileState::failed || line_.keep_going;
  }

  // Waits until everything written is on disk; warns on failure.
  Status store() const {
    std::set<dev_t> stored;
    std::set<std::string> folders = written_folders_;
    if (!folders.empty()) folders.insert(line_.out_dir);  // for the journal
    for (const std::string& folder : folders) {
      const std::string path = folder.empty() ? "." : folder;
      struct stat status {};
      if (stat(path.c_str(), &status) != 0 || !stored.insert(status.st_dev).second) continue;
      if (Status step = store_files(path); !step) return step;
    }
    return {};
  }

  int finish() {
    // The journal first, so that one wait covers all. It may reach the disk before the outputs that
    // it lists, as it is verified when used.
    Status status = journal_->tidy();
    const Status stored = store();
    if (!stored) context_.diagnose(stored.error());
    if (!journal_trouble_) status = journal_trouble_;
    if (!status) {
      Diagnostic warning = status.error();
      warning.severity = Severity::warning;
      context_.diagnose(std::move(warning));
    }
    if (const std::string more = messages_.more(); !more.empty()) {
      write_message(console_.get(), more);
    }
    context_.end_messages();
    if (tally_.failed() > 0) context_.diagnose(tally_.failure(line_.keep_going));
    const std::string part =
        line_.shard.empty() ? "" : fmt::format(" of {} (part {})", list_.total, line_.shard);
    context_.log(fmt::format("{}: {}", context_.report.tool, tally_.summary(part)));
    const Status reported = report_.end(context_.report.issues, tally_.result());
    if (!reported) {
      Error error = reported.error();
      error.hint = "the outputs were written";
      context_.diagnose(std::move(error));
      return kExitTrouble;
    }
    if (!stored) return kExitTrouble;
    if (tally_.failed() == 0) return kExitDone;
    return line_.keep_going ? kExitPartly : kExitTrouble;
  }

  const MakeToolSpec& make_spec_;
  const CommandLine& line_;
  ToolContext context_;  // of the whole batch
  std::unique_ptr<Console> console_;
  Progress no_progress_;
  BatchList list_;
  BatchNames names_{list_, line_.out_dir};
  BatchReport report_;
  std::optional<Journal> journal_;
  std::optional<io::Takes> takes_;
  int jobs_of_a_file_ = 1;
  std::optional<ReadyLines> ready_lines_;
  BatchTally tally_;
  AlikeMessages messages_;
  std::set<std::string> written_folders_;
  Status journal_trouble_;
};

// Whether a command line asks for batch mode.
bool is_for_many(const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) {
    if (argument == "--") return false;
    for (const std::string option : {"--out-dir", "--manifest"}) {
      if (argument == option || argument.rfind(option + "=", 0) == 0) return true;
    }
  }
  return false;
}

}  // namespace

int run_tool(const MakeToolSpec& make_spec, int argc, char** argv) {
  return cli::run_tool(make_spec, argc, argv,
                       {is_for_many, [](const MakeToolSpec& spec, const CommandLine& line) {
                          return Batch(spec, line).run();
                        }});
}

}  // namespace krok::cli::batch
