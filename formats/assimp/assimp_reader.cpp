#include "formats/assimp/assimp_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/bytes.h"
#include "core/child_process.h"
#include "core/file.h"
#include "formats/assimp/companions_internal.h"
#include "formats/assimp/find_images_internal.h"
#include "formats/assimp/run_assimp_internal.h"
#include "formats/assimp/scene_transfer.h"
#include "formats/registry/registry.h"

namespace krok::assimp {

using registry::Kind;

namespace {

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
      return Error(
          "assimp-time",
          fmt::format(
              "Assimp was stopped after {:.4g} seconds, the time limit for a file of this size",
              limits.seconds),
          "allow more with --limit-time; if that does not help, " + hint);
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
