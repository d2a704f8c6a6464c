#include "formats/assimp/assimp_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/bytes.h"
#include "core/file.h"
#include "core/path_inside.h"
#include "core/text.h"
#include "formats/assimp/fbx_elements_internal.h"
#include "formats/assimp/run_assimp_internal.h"
#include "formats/assimp/scene_transfer.h"
#include "formats/registry/registry.h"

namespace krok::assimp {

namespace {

// Opened companion files of a given file, with diagnostics.
struct Companions {
  struct Entry {
    std::string name;  // as Assimp will request it, without a folder
    InputFile file;
    std::string text;  // replaces the file's content for Assimp, unless empty

    std::span<const std::byte> bytes() const {
      return text.empty() ? file.bytes() : std::as_bytes(std::span(text));
    }
  };
  std::vector<Entry> files;
  Diagnostics diagnostics;
};

using registry::Kind;
namespace fs = std::filesystem;

class CompanionFinder {
 public:
  CompanionFinder(const std::string& path, std::uint64_t most_bytes)
      : path_(path), folder_(fs::path(path).parent_path()), most_bytes_(most_bytes) {
    if (folder_.empty()) folder_ = ".";
  }

  Companions found;

  void tell(Severity severity, std::string message, std::string hint = {}) {
    found.diagnostics.push_back(
        make_diagnostic(severity, "assimp-companion", std::move(message), std::move(hint)));
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

// MD5: the mesh of a motion, or the motion of a mesh. SMD: the list of motions and the motions.
// Assimp sees the given file as `file.<kind>`. Files outside the folder tree of `path` are left out
// with a warning, as are those larger than `most_bytes`.
Companions find_companions(const std::string& path, Kind kind, std::string_view text,
                           std::uint64_t most_bytes) {
  if (path == "-") return {};
  CompanionFinder finder(path, most_bytes);
  if (kind == Kind::md5mesh) find_md5_motion(finder, text);
  if (kind == Kind::md5anim) find_md5_mesh(finder, text);
  if (kind == Kind::smd) find_smd_motions(finder, path);
  return std::move(finder.found);
}

namespace fs = std::filesystem;

class ImageFinder {
 public:
  ImageFinder(const std::string& path, std::uint64_t most_bytes, nodes::Scene& scene)
      : folder_(folder_of(path)), bytes_left_(most_bytes), scene_(scene) {}

  void fill_in(Texture& texture) {
    if (!texture) return;
    const auto [place, added] = known_.try_emplace(texture.image);
    if (added) place->second = found(*texture.image);
    if (place->second == nullptr) {
      texture = Texture();
    } else {
      texture.image = place->second;
    }
  }

 private:
  using Shared = std::shared_ptr<const EncodedImage>;

  Shared found(const EncodedImage& named) {
    EncodedImage image = named;
    if (image.bytes.empty()) {
      auto file = open(image.path);
      if (!file) return warn(named, "is not in the file's folder", "copy it there");
      image.path = file->path();
      image.bytes.assign(file->bytes().begin(), file->bytes().end());
      bytes_left_ -= std::min<std::uint64_t>(bytes_left_, image.bytes.size());
    }
    const auto facts = image_info(image.bytes);
    if (!facts) {
      return warn(named, "cannot be used: " + facts.error().message, facts.error().hint);
    }
    if (named.bytes.empty()) scene_.files.push_back(image.path);
    return std::make_shared<const EncodedImage>(std::move(image));
  }

  Shared warn(const EncodedImage& image, const std::string& why, const std::string& hint) {
    Diagnostic warning;
    warning.severity = Severity::warning;
    warning.code = "assimp-picture";
    std::string path = image.path;
    std::replace(path.begin(), path.end(), '\\', '/');
    warning.message = fmt::format("the image '{}' {}; it is left out", shown(base_name(path)), why);
    warning.hint = hint;
    scene_.diagnostics.push_back(std::move(warning));
    return nullptr;
  }

  std::optional<InputFile> open(std::string name) const {
    std::replace(name.begin(), name.end(), '\\', '/');
    while (name.starts_with("./")) name.erase(0, 2);
    const std::string base = base_name(name);
    std::vector<std::string> candidates = {name, base, "textures/" + base};
    for (const char* folder : {"", "textures/"}) {
      for (const std::string& other : same_but_for_case(folder, base)) candidates.push_back(other);
    }
    for (const std::string& candidate : candidates) {
      const auto path = path_inside(folder_, candidate);
      std::error_code trouble;
      if (!path || !fs::is_regular_file(*path, trouble)) continue;
      auto file = InputFile::open(*path, bytes_left_);
      if (file) return *std::move(file);
    }
    return std::nullopt;
  }

  // Most of these formats come from systems with case-insensitive file names.
  std::vector<std::string> same_but_for_case(const std::string& below,
                                             const std::string& base) const {
    std::vector<std::string> found;
    std::error_code trouble;
    for (fs::directory_iterator entry(fs::path(folder_) / below, trouble), end;
         !trouble && entry != end; entry.increment(trouble)) {
      const std::string name = entry->path().filename().string();
      if (same_word(name, base)) found.push_back(below + name);
    }
    std::sort(found.begin(), found.end());
    return found;
  }

  const std::string folder_;
  std::uint64_t bytes_left_;
  nodes::Scene& scene_;
  std::map<Shared, Shared> known_;
};

// Loads images that the scene's materials reference but that are not embedded. Searches the folder
// tree of the file at `path` for the referenced path, then the file's folder and its subfolder
// "textures" for the base name, ignoring case. An image replaces the material's base colour.
// Missing and invalid images are removed, with a warning (code assimp-picture). Reads at most
// `most_bytes`. Adds the paths of the images to the scene's files.
void find_images(const std::string& path, std::uint64_t most_bytes, nodes::Scene& scene) {
  ImageFinder finder(path, most_bytes, scene);
  for (Material& material : scene.materials) {
    for (Texture* texture : textures_of(material)) finder.fill_in(*texture);
    // In these formats an image replaces the colour.
    if (material.base_color_texture) material.base_color.head<3>().setOnes();
    if (material.emissive_texture) material.emissive.setOnes();
  }
}

}  // namespace

using registry::Kind;

namespace {

constexpr int kOldestFbx = 7100;  // that Assimp reads

constexpr std::string_view kHint =
    "the file is probably damaged; try to open and save it in another program, preferably as glTF "
    "(.glb)";

// The child's answer: an error, or a scene.
std::vector<std::byte> pack_result(const Result<nodes::Scene>& result) {
  ByteWriter out;
  out.write(static_cast<std::uint8_t>(result.ok()));
  if (result) {
    out.append(pack(*result));
  } else {
    out.write(static_cast<std::uint64_t>(result.error().message.size()));
    out.append_text(result.error().message);
    out.append_text(result.error().hint);
  }
  return std::move(out.buffer());
}

Result<nodes::Scene> unpack_result(std::span<const std::byte> bytes) {
  ByteReader in(bytes);
  if (in.read<std::uint8_t>() == 1) return unpack(bytes.subspan(1));
  const auto size = in.read<std::uint64_t>();
  const std::string message(in.take_text(static_cast<std::size_t>(size)));
  const std::string hint(in.take_text(in.remaining()));
  if (!in.ok() || message.empty()) return unpack({});
  return Error("assimp-refused", message, hint);
}

Error error_of(const ChildReport& report, const ChildLimits& limits) {
  const std::string hint(kHint);
  switch (report.end) {
    case ChildEnd::out_of_time:
      return Error("assimp-time",
                   fmt::format("Assimp was stopped after {}, {} for a file of this size",
                               report.what, report.signal == 0 ? "too little" : "the time limit"),
                   report.signal == 0
                       ? "the machine is busy, or Assimp waits: try again; --limit-time allows more"
                       : "allow more with --limit-time; if that does not help, " + hint);
    case ChildEnd::out_of_memory:
      return Error("assimp-memory",
                   fmt::format("Assimp exceeded {} MiB, the memory limit for a file of this size",
                               limits.memory_bytes >> 20),
                   "allow more with --limit-memory; if that does not help, " + hint);
    case ChildEnd::result_too_large:
      return Error("assimp-memory",
                   fmt::format("the file's content exceeds the memory limit of {} MiB",
                               limits.result_bytes >> 20),
                   "allow more with --limit-memory; if that does not help, " + hint);
    case ChildEnd::not_started:
      return Error("assimp-start",
                   fmt::format("cannot start a process to read the file: {}", report.what),
                   "close some programs and try again");
    case ChildEnd::threw:
      return Error("assimp-refused",
                   fmt::format("cannot read the file; Assimp reports: {}", report.what), hint);
    case ChildEnd::crashed:
    case ChildEnd::returned:
      break;
  }
  return Error("assimp-crash",
               fmt::format("Assimp crashed while reading the file: {}", report.what), hint);
}

Result<nodes::Scene> read_in_child(const std::vector<MemoryFile>& files, Kind kind,
                                   const ReadOptions& options) {
  std::uint64_t size = 0;
  for (const MemoryFile& file : files) size += file.bytes.size();
  ChildLimits limits;
  limits.seconds = options.limits.seconds.value_or(
      options.most_seconds + options.seconds_per_mebibyte * static_cast<double>(size) / (1 << 20));
  limits.memory_bytes = options.limits.memory_bytes.value_or(
      options.most_bytes + static_cast<std::uint64_t>(std::max(options.most_expansion, 0.0) *
                                                      static_cast<double>(size)));
  limits.result_bytes = limits.memory_bytes;
  const ChildReport report =
      run_in_child([&] { return pack_result(run_assimp(files, kind, options)); }, limits);
  if (report.end != ChildEnd::returned) return error_of(report, limits);
  return unpack_result(report.bytes);
}

}  // namespace

Result<nodes::Scene> read_file(const std::string& path, const ReadOptions& options) {
  if (!(options.frames_per_second > 0) || !std::isfinite(options.frames_per_second)) {
    return Error("assimp-rate", "the frame rate must be positive").in_file(path);
  }
  const auto file = InputFile::open(path, options.most_file_bytes);
  if (!file) return file.error();
  const Kind kind = registry::identify(path, file->bytes());
  if (!registry::is_read_through_assimp(kind)) {
    return Error("assimp-kind", fmt::format("is {}, which is not read with Assimp",
                                            registry::describe_content(file->bytes())))
        .in_file(path);
  }
  // Assimp also uses the extension; here it follows from the content.
  std::vector<MemoryFile> files{{fmt::format("file.{}", registry::kind_name(kind)), file->bytes()}};
  const std::uint64_t size = file->bytes().size();
  Companions companions = find_companions(
      path, kind, file->text(), options.most_file_bytes - std::min(size, options.most_file_bytes));
  for (const Companions::Entry& companion : companions.files) {
    files.push_back({companion.name, companion.bytes()});
  }
  if (const int version = kind == Kind::fbx ? fbx_version(file->text()) : 0;
      version > 0 && version < kOldestFbx) {
    return Error("assimp-version",
                 fmt::format("is FBX {}.{}; 7.1 (2011) is the oldest that is read", version / 1000,
                             version / 100 % 10),
                 "convert it to FBX 2013 with Autodesk's FBX Converter (free), or open it in Maya, "
                 "MotionBuilder or 3ds Max and export it anew; Blender does not read it either")
        .in_file(path);
  }
  auto scene = read_in_child(files, kind, options);
  if (!scene) return std::move(scene.error()).in_file(path);
  if (options.with_materials) find_images(path, options.most_file_bytes, *scene);
  scene->diagnostics.insert(scene->diagnostics.begin(), companions.diagnostics.begin(),
                            companions.diagnostics.end());
  for (Diagnostic& diagnostic : scene->diagnostics) diagnostic.where.file = path;
  for (const Companions::Entry& companion : companions.files) {
    scene->files.push_back(companion.file.path());
  }
  if (scene->meshes.empty() && scene->animations.empty() && scene->cameras.empty() &&
      scene->nodes.size() < 2) {
    return Error("assimp-empty", "the file has no mesh, skeleton, animation or camera",
                 "check the export settings")
        .in_file(path);
  }
  return scene;
}

}  // namespace krok::assimp
