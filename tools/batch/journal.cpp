#include "tools/batch/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <numeric>

#include "core/hash.h"
#include "core/numbers.h"
#include "core/text.h"
#include "tools/cli/paths.h"

namespace krok::cli::batch {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kEnd = ".journal.jsonl";

// JSON is UTF-8 and file names are any bytes but zero: of a name that is not UTF-8 a record has a
// zero, then each byte as the character of that number.
std::string recorded(const std::string& name) {
  return is_utf8(name) ? name : std::string(1, '\0') + to_utf8(name);
}

std::string name_of_recorded(const std::string& text) {
  if (!text.starts_with('\0')) return text;
  std::string name;
  for (const char32_t byte : code_points(std::string_view(text).substr(1))) {
    name += static_cast<char>(byte);
  }
  return name;
}

std::string text_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_string()) return {};
  return name_of_recorded(found->get<std::string>());
}

std::uint64_t checksum_of_line(std::string_view line) {
  return xxh3(std::as_bytes(std::span(line)));
}

std::string checksum(const InputFile& file) {
  return hex(file.checksum());
}

bool output_holds(const Json& output, const std::string& folder) {
  const std::string path = below(folder, text_of(output, "path"));
  const auto size = output.find("size");
  std::error_code missing;
  if (size == output.end() || !size->is_number_unsigned() ||
      fs::file_size(path, missing) != size->get<std::uintmax_t>() || missing) {
    return false;
  }
  const auto file = InputFile::open(path);
  return file && checksum(*file) == text_of(output, "xxh3");
}

const Json& array_of(const Json& record, const char* key) {
  static const Json empty = Json::array();
  const auto found = record.find(key);
  return found != record.end() && found->is_array() ? *found : empty;
}

// A path for a journal in `folder`: relative if inside it, otherwise unchanged.
std::string from_folder(const std::string& folder, const std::string& path) {
  if (folder.empty() || fs::path(path).is_absolute() != fs::path(folder).is_absolute()) return path;
  const fs::path relative =
      fs::path(path).lexically_normal().lexically_relative(fs::path(folder).lexically_normal());
  return relative.empty() ? path : relative.string();
}

// Checksum of the names and sizes of the files in a folder with this suffix, ".asf", or of this
// name.
std::string names_checksum(const std::string& folder, const std::string& ending) {
  std::vector<std::string> names;
  const auto add = [&](const fs::directory_entry& entry) {
    std::error_code no_file;
    names.push_back(
        fmt::format("{}\n{}\n", entry.path().filename().string(), entry.file_size(no_file)));
  };
  std::error_code unknown;
  if (!ending.starts_with('.')) {
    const fs::directory_entry file(below(folder, ending), unknown);
    if (file.exists(unknown)) add(file);
  } else {
    for (fs::directory_iterator entry(folder.empty() ? "." : folder, unknown), end; entry != end;
         entry.increment(unknown)) {
      if (extension(entry->path().filename().string()) == ending) add(*entry);
    }
  }
  std::sort(names.begin(), names.end());
  std::string text;
  for (const std::string& name : names) text += name;
  return hex(xxh3(std::as_bytes(std::span(text))));
}

Error unwritable_error(const std::string& why, const std::string& path) {
  return Error("journal-unwritable", fmt::format("cannot write: {}", why),
               "the next run will process these files again")
      .in_file(path);
}

}  // namespace

Journal::Journal(const std::string& folder, const std::string& tool, const std::string& suffix)
    : folder_(folder), path_(below(folder, tool + suffix + std::string(kEnd))) {
  std::vector<std::string> paths;
  std::error_code missing;
  for (fs::directory_iterator entry(folder.empty() ? "." : folder, missing), end; entry != end;
       entry.increment(missing)) {
    const std::string name = entry->path().filename().string();
    if (name.rfind(tool + ".", 0) == 0 && name.ends_with(kEnd)) {
      paths.push_back(below(folder, name));
    }
  }
  std::sort(paths.begin(), paths.end());
  for (const std::string& path : paths) read(path);
}

Journal::~Journal() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void Journal::read(const std::string& path) {
  auto file = InputFile::open(path);
  if (!file) return;
  files_.push_back(std::move(*file));
  const std::string_view text = files_.back().text();
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string_view::npos) break;  // incomplete line of a killed run
    const std::string_view whole = text.substr(at, end - at);
    if (const std::string output = output_of(whole); !output.empty()) {
      index_[output].push_back({files_.size() - 1, at, whole.size()});
    }
    at = end + 1;
  }
}

// Empty if the line is not a record.
std::string Journal::output_of(std::string_view line) const {
  // Lines of this run need no parsing.
  const auto added = added_outputs_.find(checksum_of_line(line));
  if (added != added_outputs_.end()) return added->second;
  const Json record = parse_ordered_json(line);
  return record.is_object() ? text_of(record, "output") : std::string();
}

std::string_view Journal::line(const LineRange& place) const {
  return files_[place.file].text().substr(place.begin, place.size);
}

Result<std::string> Journal::checksum_of_input(const std::string& path) const {
  const std::lock_guard lock(checking_);
  if (const auto found = input_checksums_.find(path); found != input_checksums_.end()) {
    return found->second;
  }
  const auto file = InputFile::open(path);
  if (!file) return file.error();
  return input_checksums_[path] = checksum(*file);
}

std::string Journal::checksum_of_choice(const std::string& folder,
                                        const std::string& ending) const {
  const std::lock_guard lock(checking_);
  std::string& known = choice_checksums_[{folder, ending}];
  if (known.empty()) known = names_checksum(folder, ending);
  return known;
}

std::optional<Json> Journal::unchanged(const std::string& output, const std::string& made_with,
                                       const std::string& input) const {
  const auto found = index_.find(output);
  if (found == index_.end()) return std::nullopt;
  std::string input_checksum;
  // Newest first.
  for (auto place = found->second.rbegin(); place != found->second.rend(); ++place) {
    Json record = parse_ordered_json(line(*place));
    if (!record.is_object() || text_of(record, "made_with") != made_with) continue;
    const std::string recorded_input = text_of(record, "input");
    bool holds = !array_of(record, "inputs").empty() && !array_of(record, "outputs").empty();
    for (Json& source : record["inputs"]) {
      if (!holds) break;
      const std::string path = text_of(source, "path");
      if (path != recorded_input) {
        const auto now = checksum_of_input(path);
        holds = now && *now == text_of(source, "xxh3");
        continue;
      }
      if (input_checksum.empty()) {
        const auto file = InputFile::open(input);
        if (!file) return std::nullopt;
        input_checksum = checksum(*file);
      }
      holds = input_checksum == text_of(source, "xxh3");
      source["path"] = input;
    }
    const auto folder_of = [](const std::string& path) {
      return fs::path(path).parent_path().string();
    };
    for (const Json& choice : array_of(record, "choices")) {
      std::string folder = text_of(choice, "folder");
      if (folder == folder_of(recorded_input)) folder = folder_of(input);
      holds =
          holds && checksum_of_choice(folder, text_of(choice, "ending")) == text_of(choice, "xxh3");
    }
    for (const Json& written : array_of(record, "outputs")) {
      holds = holds && output_holds(written, folder_);
    }
    if (!holds) continue;
    for (const char* list : {"inputs", "outputs"}) {
      for (Json& file : record[list]) file["path"] = text_of(file, "path");
    }
    return record;
  }
  return std::nullopt;
}

Status Journal::add(const Json& record) {
  std::string text = json_text(record) + "\n";
  const std::uint64_t sum = checksum_of_line(std::string_view(text).substr(0, text.size() - 1));
  const std::lock_guard lock(adding_);
  const auto fail = [&] { return unwritable_error(std::strerror(errno), path_); };
  if (descriptor_ < 0) {
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (descriptor_ < 0) return fail();
    // Start a new line after an incomplete line of a killed run.
    const off_t size = lseek(descriptor_, 0, SEEK_END);
    char last = '\n';
    if (size > 0 && pread(descriptor_, &last, 1, size - 1) == 1 && last != '\n') text = "\n" + text;
  }
  added_outputs_[sum] = text_of(record, "output");
  for (std::string_view rest = text; !rest.empty();) {
    const ssize_t count = ::write(descriptor_, rest.data(), rest.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return fail();
    rest.remove_prefix(static_cast<std::size_t>(count));
  }
  return {};
}

Status Journal::tidy() {
  if (added_outputs_.empty()) return {};
  ::close(descriptor_);
  descriptor_ = -1;
  files_.clear();
  index_.clear();
  read(path_);
  std::vector<std::string> outputs;
  for (const auto& [output, places] : index_) outputs.push_back(output);
  std::sort(outputs.begin(), outputs.end());
  // Written to a new file without waiting for the disk, under a name that is not a journal's.
  const std::string anew = path_ + ".new";
  std::error_code trouble;
  fs::remove(anew, trouble);  // from a killed run
  auto file = OutputFile::create(anew, {.stored_later = true});
  if (!file) return file.error();
  for (const std::string& output : outputs) {
    if (Status status = file->write(line(index_[output].back())); !status) return status;
    if (Status status = file->write("\n"); !status) return status;
  }
  if (Status status = file->commit(); !status) return status;
  fs::rename(anew, path_, trouble);
  // Close the replaced journal, so that the system need not write it to disk.
  files_.clear();
  index_.clear();
  if (!trouble) return {};
  std::error_code gone;
  fs::remove(anew, gone);
  return unwritable_error(trouble.message(), path_);
}

Result<Json> journal_record(const std::string& folder, const std::string& output,
                            const std::string& made_with, const std::string& input, Report& report,
                            const std::map<std::string, std::string>& places) {
  Json record = object_for(9);
  record["output"] = recorded(output);
  record["made_with"] = made_with;
  record["version"] = report.version;
  record["input"] = recorded(input);
  record["inputs"] = to_json(report.inputs);
  for (Json& source : record["inputs"]) {
    source["path"] = recorded(source["path"].get_ref<const std::string&>());
  }
  record["choices"] = Json::array();
  for (const Report::Choice& choice : report.choices) {
    record["choices"].push_back({{"folder", recorded(choice.folder)},
                                 {"ending", recorded(choice.ending)},
                                 {"xxh3", names_checksum(choice.folder, choice.ending)}});
  }
  record["outputs"] = Json::array();
  for (const std::string& path : report.outputs) {
    const auto held = places.find(path);
    const auto file = InputFile::open(held == places.end() ? path : held->second);
    if (!file) return file.error();
    Json& place = record["outputs"].emplace_back(object_for(3));
    place["path"] = recorded(from_folder(folder, path));
    place["size"] = file->bytes().size();
    place["xxh3"] = checksum(*file);
  }
  record["issues"] = to_json(report.issues);
  record["result"] = std::move(report.result);
  return record;
}

namespace {

// Max number of failed files that are named.
constexpr std::size_t kNamed = 10;

}  // namespace

const char* name_of(FileState state) {
  constexpr std::array kNames = {"done", "unchanged", "left out", "failed"};  // [FileState]
  return kNames[static_cast<std::size_t>(state)];
}

void BatchTally::add(FileState state, const std::string& name, bool warned) {
  if (state == FileState::done && warned) ++warned_;
  ++counts_[static_cast<std::size_t>(state)];
  if (state == FileState::failed && failed_.size() < kNamed) failed_.push_back(name);
}

std::size_t BatchTally::left() const {
  return files_ - std::accumulate(counts_.begin(), counts_.end(), std::size_t{0});
}

Json BatchTally::result() const {
  Json json;
  json["files"] = files_;
  json["done"] = count(FileState::done);
  json["with_warnings"] = warned_;
  json["unchanged"] = count(FileState::unchanged);
  if (count(FileState::left_out) > 0) json["left_out"] = count(FileState::left_out);
  json["failed"] = failed();
  json["left"] = left();
  return json;
}

std::string BatchTally::summary(const std::string& of_what) const {
  std::string text = counted(files_, "file") + of_what;
  const auto add = [&](std::size_t number, const char* what) {
    if (number > 0) text += fmt::format(", {} {}", number, what);
  };
  add(count(FileState::done), "done");
  add(count(FileState::unchanged), "unchanged");
  add(count(FileState::left_out), "left out");
  add(failed(), "failed");
  add(left(), "left");
  if (warned_ > 0) text += fmt::format("; {} with warnings", warned_);
  return text;
}

Error BatchTally::failure(bool kept_going) const {
  std::string names;
  for (const std::string& name : failed_) names += (names.empty() ? "" : ", ") + name;
  if (!kept_going) {
    return Error("batch-stopped",
                 fmt::format("stopped at {}, the first file that failed; {} left", names, left()),
                 "use --keep-going to process the others; finished files are not processed again");
  }
  const std::size_t more = failed() - failed_.size();
  if (more > 0) names += fmt::format(" and {} more", more);
  return Error("batch-failed", fmt::format("{} failed: {}", counted(failed(), "file"), names));
}

}  // namespace krok::cli::batch
