#include "formats/assimp/run_assimp_internal.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <fmt/format.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <cstring>
#include <new>

#include "core/text.h"
#include "formats/assimp/collada_text_internal.h"
#include "formats/assimp/conversion_internal.h"
#include "formats/assimp/curve_internal.h"
#include "nodes/evaluate.h"

namespace krok::assimp {

using namespace nodes;

namespace {

void cut(Channel& channel, float start, float end) {
  const std::vector<float>& times = *channel.times;
  std::vector<float> kept = {start};
  for (const float time : times) {
    if (time > start && time < end) kept.push_back(time);
  }
  kept.push_back(end);
  std::vector<float> new_times, new_values;
  std::vector<double> value(static_cast<std::size_t>(channel.width));
  for (const float time : kept) {
    const float shifted = time - start;
    if (!new_times.empty() && shifted <= new_times.back()) continue;
    sample(channel, static_cast<double>(time), value);
    new_times.push_back(shifted);
    for (const double number : value) new_values.push_back(static_cast<float>(number));
  }
  channel.times = std::make_shared<const std::vector<float>>(std::move(new_times));
  channel.values = std::make_shared<const std::vector<float>>(std::move(new_values));
}

class MemoryStream : public Assimp::IOStream {
 public:
  explicit MemoryStream(std::span<const std::byte> bytes) : bytes_(bytes) {}

  size_t Read(void* buffer, size_t size, size_t count) override {
    if (size == 0) return 0;
    const std::size_t whole = std::min(count, (bytes_.size() - position_) / size);
    if (whole == 0) return 0;
    std::memcpy(buffer, bytes_.data() + position_, whole * size);
    position_ += whole * size;
    return whole;
  }

  size_t Write(const void*, size_t, size_t) override { return 0; }

  aiReturn Seek(size_t offset, aiOrigin origin) override {
    std::size_t position = offset;
    if (origin == aiOrigin_CUR) position = position_ + offset;
    if (origin == aiOrigin_END) position = bytes_.size() - offset;
    if (position > bytes_.size()) return aiReturn_FAILURE;
    position_ = position;
    return aiReturn_SUCCESS;
  }

  size_t Tell() const override { return position_; }
  size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
};

}  // namespace

// Sets the animation's name to the clip's and, if the clip has a time range, trims the animation to
// it, starting at 0.
void shape_clip(const ColladaClip& clip, Animation& animation) {
  animation.name = clip.name;
  if (!(clip.end > clip.start)) return;
  for (Channel& channel : animation.channels) {
    cut(channel, static_cast<float>(clip.start), static_cast<float>(clip.end));
  }
}

using registry::Kind;

namespace {

void configure(Assimp::Importer& importer) {
  // No dummy meshes for skeletons without a mesh.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  // Without the helper nodes Assimp 5.2 loses the animation of FBX nodes with pivots; convert_nodes
  // merges them.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_TEXTURES, false);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_LIGHTS, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_OPTIMIZE_EMPTY_ANIMATION_CURVES, false);
  // Keep joints without weights.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_REMOVE_EMPTY_BONES, false);
}

std::size_t meshes_without_normals(const aiScene& scene) {
  std::size_t count = 0;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) count += scene.mMeshes[m]->HasNormals() ? 0 : 1;
  return count;
}

// Assimp's message, without line ends and the final full stop.
std::string reason(const Assimp::Importer& importer) {
  std::string text = to_utf8(importer.GetErrorString());
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 32) c = ' ';
  }
  constexpr std::size_t kMax = 300;
  if (text.size() > kMax) text = to_utf8(text.substr(0, kMax)) + "...";
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
  return text.empty() ? "no reason given" : text;
}

// Throws if Assimp swallowed a bad_alloc.
void throw_on_bad_alloc(const Assimp::Importer& importer) {
  const std::exception_ptr& exception = importer.GetException();
  if (!exception) return;
  try {
    std::rethrow_exception(exception);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (...) {
  }
}

}  // namespace

void Conversion::note(std::string code, std::string message, std::string hint) {
  scene.diagnostics.push_back(
      make_diagnostic(Severity::note, std::move(code), std::move(message), std::move(hint)));
}

void Conversion::warn(std::string code, std::string message, std::string hint) {
  scene.diagnostics.push_back(make_warning(std::move(code), std::move(message), std::move(hint)));
}

namespace {

// Reads the animations of all COLLADA clips after the first, one import each.
void convert_further_clips(Conversion& to, const std::vector<ColladaClip>& clips) {
  constexpr std::size_t kMaxClips = 100;
  if (clips.empty()) return;
  std::vector<nodes::Animation>& animations = to.scene.animations;
  if (animations.size() == 1) shape_clip(clips[0], animations[0]);
  const std::size_t count = std::min(clips.size(), kMaxClips);
  if (count < clips.size()) {
    to.warn("assimp-clips",
            fmt::format("of {} clips, only the first {} are read", clips.size(), count));
  }
  for (std::size_t c = 1; c < count; ++c) {
    const std::string text = collada_with_one_animation(to.text, &clips[c]);
    if (text.empty()) return;
    Assimp::Importer importer;
    configure(importer);
    importer.SetIOHandler(new MemoryFiles({{"clip.dae", std::as_bytes(std::span(text))}}));
    const aiScene* source = importer.ReadFile("clip.dae", 0);
    throw_on_bad_alloc(importer);
    if (source == nullptr) throw ConversionError(reason(importer));
    const std::size_t before = animations.size();
    convert_animations(to, *source);
    for (std::size_t a = before; a < animations.size(); ++a) shape_clip(clips[c], animations[a]);
  }
}

std::string_view text_of(const MemoryFile& file) {
  return {reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size()};
}

// Input for Assimp.
struct Input {
  std::vector<MemoryFile> files;
  std::vector<std::string> converted;  // files that were UTF-16
  std::vector<std::string> mended;     // replacements of some files
  std::string name;                    // of the file to open
  std::string_view text;               // the file to open, mended
  bool bare_motion = false;            // an MD5 motion without its mesh
  std::vector<ColladaClip> clips;
  std::string resampled;             // the file to open, with its curves resampled
  std::optional<Resampling> curves;  // nullopt if they could not be read
};

// Replaces the file to open by one that Assimp's interpolation does not change.
void resample_curves(Kind kind, MemoryFile& file, Input& input) {
  std::optional<ResampledFile> resampled;
  if (kind == Kind::fbx) resampled = resample_fbx(text_of(file));
  if (kind == Kind::collada) resampled = resample_collada(text_of(file));
  if (!resampled) return;
  input.curves = resampled->result;
  input.resampled = std::move(resampled->text);
  if (!input.resampled.empty()) file.bytes = std::as_bytes(std::span(input.resampled));
}

Result<Input> prepare(std::vector<MemoryFile> files, Kind kind) {
  Input input;
  input.mended.resize(files.size() + 1);
  input.converted.resize(files.size());
  for (std::size_t f = 0; f < files.size(); ++f) {
    std::string& converted = input.converted[f];
    converted = utf8_of(text_of(files[f]));
    if (!converted.empty()) files[f].bytes = std::as_bytes(std::span(converted));
  }
  input.text = text_of(files[0]);
  if (kind == Kind::collada) {
    auto mend = mend_input(kind, input.text);
    if (!mend) return mend.error();
    std::string& mended = input.mended.back();
    mended = std::move(*mend);
    if (!mended.empty()) files[0].bytes = std::as_bytes(std::span(mended));
    resample_curves(kind, files[0], input);
    input.text = text_of(files[0]);
    input.clips = collada_clips(input.text);
  }
  if (kind == Kind::fbx) resample_curves(kind, files[0], input);
  for (std::size_t f = 0; f < files.size(); ++f) {
    std::string& mended = input.mended[f];
    if (kind == Kind::collada) {
      const ColladaClip* first = input.clips.empty() ? nullptr : &input.clips[0];
      mended = collada_with_one_animation(input.text, first);
    } else {
      auto mend = mend_input(registry::kind_of_name(files[f].name), text_of(files[f]));
      if (!mend) return mend.error();
      mended = std::move(*mend);
    }
    if (!mended.empty()) files[f].bytes = std::as_bytes(std::span(mended));
  }
  // An MD5 motion is read through its mesh, if there is one.
  const auto mesh = std::find_if(files.begin(), files.end(), [](const MemoryFile& file) {
    return registry::kind_of_name(file.name) == Kind::md5mesh;
  });
  input.bare_motion = kind == Kind::md5anim && mesh == files.end();
  input.name = kind == Kind::md5anim && !input.bare_motion ? mesh->name : files[0].name;
  input.files = std::move(files);
  return input;
}

Status convert(Conversion& to, const Input& input) {
  try {
    convert_nodes(to);
    if (!input.bare_motion) convert_meshes(to);  // Assimp adds a dummy mesh to bare bones
    convert_cameras(to);
    mark_fixtures(to);
    mark_bones(to);
    convert_animations(to, to.source);
    convert_further_clips(to, input.clips);
    convert_space(to);
    report_same_names(to);
    rename_collada_nodes(to);
  } catch (const ConversionError& error) {
    return Error("assimp-refused", fmt::format("cannot read the file: {}", error.what()),
                 "the file is damaged, or its exporter has a bug");
  }
  return {};
}

}  // namespace

Result<nodes::Scene> run_assimp(std::vector<MemoryFile> files, Kind kind,
                                const ReadOptions& options) {
  auto input = prepare(std::move(files), kind);
  if (!input) return input.error();
  Assimp::Importer importer;
  configure(importer);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_TEXTURES, options.with_materials);
  importer.SetIOHandler(new MemoryFiles(input->files));  // the importer deletes it
  const aiScene* source = importer.ReadFile(input->name, 0);
  throw_on_bad_alloc(importer);
  std::size_t without_normals = 0;
  if (source != nullptr && source->mNumMeshes > 0 && !input->bare_motion) {
    without_normals = meshes_without_normals(*source);
    source = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_GenSmoothNormals);
    throw_on_bad_alloc(importer);
  }
  if (source == nullptr || source->mRootNode == nullptr) {
    return Error("assimp-refused",
                 fmt::format("cannot read the file; Assimp reports: {}", reason(importer)),
                 "try to open and save it in another program, preferably as glTF (.glb)");
  }
  Conversion to{
      *source, kind, input->text, options.frames_per_second, options.with_materials, {}, {},
      {},      {},   {}};
  if (auto done = convert(to, *input); !done) return done.error();
  if (without_normals > 0) {
    to.note("assimp-normals",
            fmt::format("{} meshes have no normals; smooth ones were computed", without_normals));
  }
  report_takes(to);
  report_curves(to, input->curves);
  report_what_is_missing(to);
  return std::move(to.scene);
}

const MemoryFile* MemoryFiles::find(const char* path) const {
  std::string_view name = path;
  name.remove_prefix(name.find_last_of("/\\") + 1);  // npos + 1 is 0
  for (const MemoryFile& file : files_) {
    if (same_word(file.name, name)) return &file;
  }
  return nullptr;
}

bool MemoryFiles::Exists(const char* path) const {
  return find(path) != nullptr;
}

Assimp::IOStream* MemoryFiles::Open(const char* path, const char* mode) {
  if (std::strchr(mode, 'r') == nullptr || std::strchr(mode, '+') != nullptr) return nullptr;
  const MemoryFile* file = find(path);
  return file == nullptr ? nullptr : new MemoryStream(file->bytes);
}

void MemoryFiles::Close(Assimp::IOStream* stream) {
  delete stream;
}

}  // namespace krok::assimp
