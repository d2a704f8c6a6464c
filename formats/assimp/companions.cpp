#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "core/text.h"
#include "formats/assimp/companions_internal.h"
#include "formats/assimp/mend_input_internal.h"

namespace krok::assimp {

using registry::Kind;
namespace fs = std::filesystem;

namespace {

class CompanionFinder {
 public:
  CompanionFinder(const std::string& path, std::uint64_t most_bytes)
      : path_(path), folder_(fs::path(path).parent_path()), most_bytes_(most_bytes) {
    if (folder_.empty()) folder_ = ".";
  }

  Companions found;

  void tell(Severity severity, std::string message, std::string hint = {}) {
    Diagnostic diagnostic;
    diagnostic.severity = severity;
    diagnostic.code = "assimp-companion";
    diagnostic.message = std::move(message);
    diagnostic.hint = std::move(hint);
    found.diagnostics.push_back(std::move(diagnostic));
  }

  // Files in the folder with this extension, sorted by name.
  std::vector<fs::path> with_ending(const std::string& ending) const {
    std::vector<fs::path> paths;
    std::error_code trouble;
    for (fs::directory_iterator entry(folder_, trouble), end; !trouble && entry != end;
         entry.increment(trouble)) {
      if (extension(entry->path().string()) == ending) paths.push_back(entry->path());
    }
    std::sort(paths.begin(), paths.end());
    return paths;
  }

  // The file with the same stem and another extension; empty if there is none.
  fs::path same_stem(const std::string& ending) const {
    const std::string stem = ascii_lower(fs::path(path_).stem().string());
    for (const fs::path& path : with_ending(ending)) {
      if (ascii_lower(path.stem().string()) == stem) return path;
    }
    return {};
  }

  // Whether a path is inside the folder tree, with links resolved.
  bool inside_folder(const fs::path& path) const {
    std::error_code trouble;
    const fs::path root = fs::canonical(folder_, trouble);
    if (trouble) return false;
    const fs::path real = fs::weakly_canonical(path, trouble);
    if (trouble) return false;
    const auto [end, rest] = std::mismatch(root.begin(), root.end(), real.begin(), real.end());
    return end == root.end();
  }

  // Opens a regular file in the folder tree.
  std::optional<InputFile> open(const fs::path& path) {
    std::error_code trouble;
    if (!inside_folder(path)) {
      tell(Severity::warning,
           fmt::format("'{}' is outside the file's folder and is ignored", shown(path.string())));
      return std::nullopt;
    }
    if (!fs::is_regular_file(path, trouble)) return std::nullopt;
    auto file = InputFile::open(path.lexically_normal().string(), most_bytes_);
    if (!file) {
      tell(Severity::warning, fmt::format("'{}' {}; it is ignored", shown(path.filename().string()),
                                          file.error().message));
      return std::nullopt;
    }
    return std::move(*file);
  }

  const fs::path& folder() const { return folder_; }

 private:
  std::string path_;
  fs::path folder_;
  std::uint64_t most_bytes_;
};

void find_md5_motion(CompanionFinder& finder, std::string_view mesh) {
  const fs::path path = finder.same_stem(".md5anim");
  if (!path.empty()) {
    auto file = finder.open(path);
    if (!file) return;
    if (md5_joints(file->text()) == md5_joints(mesh)) {
      finder.tell(Severity::note, fmt::format("the motion is read from '{}' in the same folder",
                                              path.filename().string()));
      finder.found.files.push_back({"file.md5anim", std::move(*file), {}});
    } else {
      finder.tell(Severity::warning,
                  fmt::format("the motion '{}' in the same folder has other joints and is ignored",
                              path.filename().string()),
                  "import it separately");
    }
    return;
  }
  const std::size_t others = finder.with_ending(".md5anim").size();
  if (others > 0) {
    finder.tell(
        Severity::note,
        fmt::format("none of the {} motions (.md5anim) in the folder has the mesh's name", others),
        "import a motion; the mesh is then found automatically");
  }
}

void find_md5_mesh(CompanionFinder& finder, std::string_view motion) {
  const std::string joints = md5_joints(motion);
  std::vector<fs::path> candidates;
  if (const fs::path same = finder.same_stem(".md5mesh"); !same.empty()) {
    candidates.push_back(same);
  } else {
    candidates = finder.with_ending(".md5mesh");
  }
  std::vector<std::pair<fs::path, InputFile>> fitting;
  constexpr std::size_t kMaxCandidates = 64;
  candidates.resize(std::min(candidates.size(), kMaxCandidates));
  for (const fs::path& path : candidates) {
    auto file = finder.open(path);
    if (file && md5_joints(file->text()) == joints) fitting.emplace_back(path, std::move(*file));
  }
  if (fitting.size() == 1) {
    finder.tell(Severity::note, fmt::format("the mesh is read from '{}' in the same folder",
                                            fitting[0].first.filename().string()));
    finder.found.files.push_back({"file.md5mesh", std::move(fitting[0].second), {}});
  } else if (candidates.empty()) {
    finder.tell(Severity::note, "there is no mesh (.md5mesh) in the motion's folder");
  } else if (fitting.empty()) {
    finder.tell(Severity::warning,
                fmt::format("no mesh in the motion's folder has its joints (such as '{}'); it is "
                            "read without a mesh",
                            candidates[0].filename().string()));
  } else {
    finder.tell(
        Severity::warning,
        fmt::format("{} meshes in the folder have the motion's joints; it is read without a mesh",
                    fitting.size()),
        "give the mesh the motion's name");
  }
}

// A list has one line per motion: name and file, or only the file.
struct ListedMotion {
  std::string name;
  fs::path file;  // relative to the list's folder
};

std::vector<ListedMotion> listed_motions(std::string_view text) {
  std::vector<ListedMotion> motions;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty()) continue;
    const std::size_t space = line.find_first_of(" \t");
    if (space == std::string_view::npos) {
      const fs::path file = std::string(line);
      motions.push_back({file.stem().string(), file});
    } else {
      motions.push_back(
          {std::string(line.substr(0, space)), std::string(trimmed(line.substr(space)))});
    }
  }
  return motions;
}

// Assimp finds motions by base name, which two files may share, and rejects all motions if one is
// missing. It therefore gets a new list of the existing motions, with unique names.
void find_smd_motions(CompanionFinder& finder, const std::string& path) {
  const fs::path list_path = finder.folder() / (fs::path(path).stem().string() + "_animation.txt");
  std::error_code trouble;
  if (!fs::is_regular_file(list_path, trouble)) return;
  auto list = finder.open(list_path);
  if (!list) return;
  constexpr std::size_t kMaxMotions = 256;
  std::vector<ListedMotion> motions = listed_motions(list->text());
  const std::string list_name = shown(list_path.filename().string());
  if (motions.size() > kMaxMotions) {
    finder.tell(Severity::warning,
                fmt::format("of the {} motions of '{}', only the first {} are read", motions.size(),
                            list_name, kMaxMotions),
                "import the others separately");
    motions.resize(kMaxMotions);
  }
  std::string text;
  for (const ListedMotion& motion : motions) {
    auto file = finder.open(finder.folder() / motion.file);
    if (!file) {
      finder.tell(Severity::warning, fmt::format("the motion '{}' of '{}' cannot be opened",
                                                 shown(motion.file.string()), list_name));
      continue;
    }
    const std::string own_name = fmt::format("motion_{}.smd", finder.found.files.size());
    text += fmt::format("{} {}\n", motion.name, own_name);
    finder.found.files.push_back({own_name, std::move(*file), {}});
  }
  if (text.empty()) return;
  finder.found.files.push_back({"file_animation.txt", std::move(*list), std::move(text)});
}

}  // namespace

Companions find_companions(const std::string& path, Kind kind, std::string_view text,
                           std::uint64_t most_bytes) {
  if (path == "-") return {};
  CompanionFinder finder(path, most_bytes);
  if (kind == Kind::md5mesh) find_md5_motion(finder, text);
  if (kind == Kind::md5anim) find_md5_mesh(finder, text);
  if (kind == Kind::smd) find_smd_motions(finder, path);
  return std::move(finder.found);
}

}  // namespace krok::assimp
