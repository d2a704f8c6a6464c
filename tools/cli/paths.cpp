#include "tools/cli/paths.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string_view>
#include <system_error>

#include "core/file.h"
#include "core/numbers.h"
#include "core/text.h"
#include "formats/io/formats.h"
#include "formats/io/inputs.h"

namespace krok::cli {

namespace fs = std::filesystem;

namespace {

// Resolves links in a folder's path; missing components are kept. Cached, as many files share a
// folder and resolving takes a system call per path component.
const std::string& real_folder(const std::string& folder) {
  thread_local std::string last, last_real;
  if (last != folder || last.empty()) {
    std::error_code error;
    const fs::path real = fs::weakly_canonical(folder, error);
    last_real = error ? folder : real.string();
    last = folder;
  }
  return last_real;
}

// Whether a path has no ".", ".." or double slash; a leading slash is allowed.
bool is_normal(std::string_view path) {
  for (std::size_t at = path.starts_with('/') ? 1 : 0;;) {
    const std::size_t end = std::min(path.find('/', at), path.size());
    const std::string_view part = path.substr(at, end - at);
    if (part.empty() || part == "." || part == "..") return false;
    if (end == path.size()) return true;
    at = end + 1;
  }
}

// "/", "b" -> "/b"; "/a", "b" -> "/a/b".
std::string joined(const std::string& folder, std::string_view name) {
  std::string path;
  path.reserve(folder.size() + 1 + name.size());
  path += folder;
  if (!folder.ends_with('/')) path += '/';
  path += name;
  return path;
}

}  // namespace

bool same_file(const std::string& first, const std::string& second) {
  if (first == "-" || second == "-") return false;
  struct stat one {
  }, other{};
  const bool first_exists = stat(first.c_str(), &one) == 0;
  if (first_exists && !S_ISREG(one.st_mode)) return false;
  const bool second_exists = stat(second.c_str(), &other) == 0;
  if (first_exists != second_exists) return false;
  if (first_exists) return one.st_dev == other.st_dev && one.st_ino == other.st_ino;
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(first, error);
  return !error && canonical == fs::weakly_canonical(second, error) && !error;
}

std::optional<FileNumber> file_number(const std::string& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return FileNumber(status.st_dev, status.st_ino);
}

std::string place_of(const std::string& path) {
  if (path == "-") return {};
  struct stat status {};
  const bool exists = lstat(path.c_str(), &status) == 0;
  const std::string absolute = absolute_path(path);
  if (exists && S_ISLNK(status.st_mode)) {
    if (stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) return {};
    std::error_code error;
    const fs::path place = fs::weakly_canonical(absolute, error);
    return error ? absolute : place.string();
  }
  if (exists && !S_ISREG(status.st_mode)) return {};
  const std::size_t slash = absolute.rfind('/');
  if (slash == std::string::npos) return absolute;  // the current folder is gone
  const std::string_view name = std::string_view(absolute).substr(slash + 1);
  return joined(real_folder(absolute.substr(0, std::max<std::size_t>(slash, 1))), name);
}

Error replaced_error(const std::string& path) {
  return Error("usage", "is an input and would be overwritten by an output", "choose another name")
      .in_file(path);
}

Error twice_error(const std::string& path) {
  return Error("usage", path + " would be written twice", "give each output its own file");
}

std::string below(const std::string& folder, const std::string& path) {
  return (fs::path(folder) / path).string();
}

std::string absolute_path(const std::string& path) {
  std::error_code unknown;
  if (is_normal(path)) {  // fast path: most are
    if (path.starts_with('/')) return path;
    const std::string folder = fs::current_path(unknown).string();
    if (!unknown) return joined(folder, path);
    return path;
  }
  const fs::path absolute = fs::absolute(path, unknown);
  return (unknown ? fs::path(path) : absolute).lexically_normal().string();
}

std::string file_name_of(const std::string& name) {
  std::string result;
  for (const char c : printable(to_utf8(name))) {
    const bool odd = std::string_view("/\\:*?\"<>|{}$`'&;!").find(c) != std::string_view::npos;
    result += odd ? '_' : c;
  }
  while (result.starts_with('.') || result.starts_with('-')) result[0] = '_';
  if (result.size() > 100) {
    std::size_t end = 100;
    while ((static_cast<unsigned char>(result[end]) & 0xC0) == 0x80) --end;
    result.resize(end);
  }
  return result;
}

std::string uri_of(const std::string& path) {
  std::string uri;
  for (const char c : path) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       std::string_view("-._~/").find(c) != std::string_view::npos;
    uri += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri;
}

std::string beside(const std::string& path, const std::string& ending) {
  std::filesystem::path result = path;
  if (!result.has_filename()) result = result.parent_path();
  std::error_code unknown;
  const bool folder = std::filesystem::is_directory(result, unknown);
  if (path == "-" || !result.has_filename() || result.filename() == ".") return {};
  return (folder ? result.string() : path_without_ending(result.string())) + ending;
}

std::string name_of_input(const std::string& path) {
  return path == "-" ? "standard input" : base_name(path);
}

std::string path_without_ending(const std::string& path) {
  const auto [file, animation] = io::address_of(path);
  const std::string stem = std::filesystem::path(file).replace_extension().string();
  return animation.empty() ? stem : stem + "_" + file_name_of(animation);
}

std::string clip_name_of(const std::string& path) {
  const std::string animation = io::address_of(path).animation;
  if (!animation.empty() && !parse_integer(animation)) return to_utf8(animation);
  if (!animation.empty()) return to_utf8(base_name(path_without_ending(path)));
  const std::string name = base_name(path);
  const std::string stem = name.substr(0, name.size() - extension(path).size());
  return path == "-" || stem.empty() ? "motion" : to_utf8(stem);
}

NamedPath named_path(const std::string& text) {
  const std::size_t equals = text.find('=');
  std::error_code unknown;
  const bool named = equals != std::string::npos && equals > 0 && text.find('/') > equals &&
                     !std::filesystem::exists(text, unknown);
  if (!named) return {{}, text};
  return {to_utf8(text.substr(0, equals)), text.substr(equals + 1)};
}

namespace {

// A capture and the .anim of its name beside it, which was made of it, are one take.
Diagnostics keep_one_of_each_take(const std::string& folder, std::vector<std::string>& paths) {
  const auto kind_of = [](const std::string& path) { return registry::kind_of_name(path); };
  const auto without_ending = [](const std::string& path) {
    return path.substr(0, path.size() - extension(path).size());
  };
  std::set<std::string> motions;
  for (const std::string& path : paths) {
    if (kind_of(path) == registry::Kind::anim) motions.insert(without_ending(path));
  }
  std::string first;
  const auto count = std::erase_if(paths, [&](const std::string& path) {
    if (kind_of(path) == registry::Kind::anim || !motions.contains(without_ending(path))) {
      return false;
    }
    if (first.empty()) first = base_name(path);
    return true;
  });
  if (count == 0) return {};
  Diagnostic twice = make_warning(
      "folder-twice",
      fmt::format("{} left out as the .anim file of the same name beside it is read: {}{}",
                  counted(static_cast<long long>(count), "capture"), shown(first),
                  count > 1 ? ", ..." : ""),
      "name the files to read both");
  twice.where.file = folder;
  return {std::move(twice)};
}

// "HEAD~1", "origin/main:walk.anim"
bool names_commit(const std::string& path) {
  const std::string name = path.substr(0, path.find_first_of("~^:@"));
  return name == "HEAD" || (name.size() < path.size() && (name == "main" || name == "master")) ||
         name.starts_with("origin/");
}

}  // namespace

std::string missing_file_hint(const std::string& path) {
  if (names_commit(path)) {
    return "check the path; for files of commits, krok git-setup once, then git diff COMMIT -- "
           "FILE";
  }
  constexpr std::size_t kMaxNames = 1000;
  std::vector<std::string> names;
  const fs::path folder = fs::path(path).parent_path();
  std::error_code unreadable;
  for (fs::directory_iterator entry(folder.empty() ? "." : folder, unreadable), end;
       !unreadable && entry != end && names.size() < kMaxNames; entry.increment(unreadable)) {
    names.push_back(entry->path().filename().string());
  }
  std::ranges::sort(names);
  // "walks.bvh" beside a folder "walks"
  const std::string stem = fs::path(path).stem().string();
  const bool is_folder =
      std::ranges::binary_search(names, stem) && fs::is_directory(folder / stem, unreadable);
  const std::string near = nearest_name(fs::path(path).filename().string(), names);
  std::string hint = "check the path";
  if (!near.empty()) hint += fmt::format("; did you mean {}?", shown((folder / near).string()));
  if (is_folder) hint += fmt::format("; {} is a folder", shown((folder / stem).string()));
  return hint;
}

Diagnostics keep_inputs(const std::string& folder, const std::vector<std::string>& endings,
                        std::vector<std::string>& paths) {
  const std::size_t all = paths.size();
  std::map<std::string, std::size_t> others;  // by ending
  const io::Format* first_motion = nullptr;
  std::erase_if(paths, [&](const std::string& path) {
    const std::string ending = extension(path);
    if (std::ranges::find(endings, ending) != endings.end()) return false;
    const io::Format& format = io::format_of(registry::kind_of_name(path));
    if (format.kind == registry::Kind::unknown || format.companion) return true;
    ++others[ending];
    if (first_motion == nullptr && format.reads_motion()) first_motion = &format;
    return true;
  });
  // Where each file is a motion; a list of files or a page has all of them.
  Diagnostics notes;
  if (endings == io::motion_endings()) notes = keep_one_of_each_take(folder, paths);
  if (others.empty()) return notes;
  std::string counts;
  std::size_t count = 0;
  for (const auto& [ending, number] : others) {
    counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", number, ending);
    count += number;
  }
  Diagnostic left_out = make_warning(
      "folder-left-out", fmt::format("{} of {} files are left out: {}", count, all, counts));
  if (first_motion != nullptr) {
    left_out.hint = registry::advice(first_motion->kind, registry::Kind::anim);
  } else {
    left_out.severity = Severity::note;
  }
  left_out.where.file = folder;
  notes.push_back(std::move(left_out));
  return notes;
}

}  // namespace krok::cli
