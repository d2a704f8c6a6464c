#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "capture/unique_names.h"
#include "core/numbers.h"
#include "core/path_inside.h"
#include "core/result.h"
#include "core/text.h"
#include "formats/csv/csv_writer.h"
#include "formats/key_shapes/key_shapes.h"
#include "formats/morph_exr/morph_exr.h"
#include "scene/morph_set.h"
#include "skin/key_frame_mesh.h"
#include "tools/krok-morph/options.h"
#include "tools/krok-morph/shape_file.h"

// Key-frame meshes: interpolates shapes over time.

namespace krok::cli::morph {

namespace {

// Key shapes with times; all files have been read.
struct KeyShapes {
  ShapeFile base;             // shape of the first key
  MorphSet shapes;            // one per file, including the first key's
  std::vector<double> times;  // [keys] seconds, ascending
  std::vector<int> shape_of;  // [keys] index into shapes
  ShapeJoin join = ShapeJoin::linear;
  double tension = 0;
  double rate = 30;
};

namespace fs = std::filesystem;

constexpr double kUsualRate = 30;
constexpr std::size_t kMaxShapeVertices = 50'000'000;  // of all shapes together

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

// Removes a run of digits, or one other character, from the start of a name. Runs compare by length
// without leading zeros, then by digits.
std::tuple<bool, std::size_t, std::string_view> take_piece(std::string_view& name) {
  std::size_t size = 0;
  while (size < name.size() && is_digit(name[size])) ++size;
  if (size == 0) {
    const std::string_view piece = name.substr(0, 1);
    name.remove_prefix(1);
    return {false, 0, piece};
  }
  std::string_view number = name.substr(0, size);
  name.remove_prefix(size);
  while (number.size() > 1 && number[0] == '0') number.remove_prefix(1);
  return {true, number.size(), number};
}

// "frame_2" before "frame_10".
bool by_number(const std::string& first, const std::string& second) {
  std::string_view a = first, b = second;
  while (!a.empty() && !b.empty()) {
    const auto left = take_piece(a), right = take_piece(b);
    if (std::get<0>(left) != std::get<0>(right)) return std::get<2>(left) < std::get<2>(right);
    if (left != right) return left < right;
  }
  if (a.empty() != b.empty()) return a.empty();
  return first < second;
}

Result<std::vector<std::string>> shapes_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end;
       entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    const std::string ending = extension(name);
    const bool shape =
        ending == ".obj" || ending == ".glb" || ending == ".gltf" || ending == ".model";
    std::error_code unknown;
    if (shape && !name.starts_with('.') && entry->is_regular_file(unknown)) names.push_back(name);
  }
  if (failed) return Error("file-unreadable", failed.message()).in_file(folder);
  if (names.empty()) {
    return Error("morph-empty", "the folder has no .obj, .glb, .gltf or .model file")
        .in_file(folder);
  }
  std::ranges::sort(names, by_number);
  return names;
}

Result<key_shapes::KeyShapeFile> keys_of_folder(const std::string& folder, double rate,
                                                const std::optional<ClipTime>& spacing) {
  auto names = shapes_in(folder);
  if (!names) return names.error();
  key_shapes::KeyShapeFile file;
  file.shapes = *std::move(names);
  const ClipTime step = spacing.value_or(ClipTime{1, true});
  for (std::size_t i = 0; i < file.shapes.size(); ++i) {
    file.times.push_back(static_cast<double>(i) * step.value / (step.in_frames ? rate : 1));
  }
  return file;
}

Result<key_shapes::KeyShapeFile> keys_of_file(const Options& options, ToolContext& context) {
  const std::string& path = options.files[0];
  if (options.spacing) {
    return Error("usage", "--spacing is for a folder; a key file has its own times");
  }
  const auto file = context.open_input(path);
  if (!file) return file.error();
  if (extension(path) == ".obj") {
    return Error("morph-input", "this is a single shape, expected a key file or a folder of shapes",
                 "key files are JSON, see formats/key_shapes/SPEC.md")
        .in_file(path);
  }
  auto keys = key_shapes::read(file->text());
  if (!keys) return std::move(keys).error().in_file(path);
  return keys;
}

Status add_shape(ShapeFile shape, const Options& options, KeyShapes& keys) {
  MorphSet& shapes = keys.shapes;
  const std::vector<Vec3f>& positions = shape.model.positions;
  if (shapes.positions.size() + positions.size() > kMaxShapeVertices) {
    return Error("morph-too-large", fmt::format("the shapes have more than {} vertices in total",
                                                grouped(kMaxShapeVertices)))
        .in_file(shape.path);
  }
  const bool first = shapes.positions.empty();
  if (!first) {
    if (Status status = check_same_mesh(keys.base, shape, options); !status) return status;
  }
  shapes.positions.insert(shapes.positions.end(), positions.begin(), positions.end());
  const std::vector<Vec3f> normals = first ? shape.model.normals : normals_for(keys.base, shape);
  shapes.normals.insert(shapes.normals.end(), normals.begin(), normals.end());
  if (first) {
    shapes.vertex_count = shape.model.vertex_count();
    keys.base = std::move(shape);
  }
  return {};
}

// Input of the action frames: a key file, or a folder with one shape per file, in natural name
// order ("2" before "10"). Options override the file.
Result<KeyShapes> read_key_shapes(const Options& options, ToolContext& context) {
  const std::string& path = options.files[0];
  std::error_code ignored;
  const bool is_folder = fs::is_directory(path, ignored);
  const auto file = is_folder
                        ? keys_of_folder(path, options.rate.value_or(kUsualRate), options.spacing)
                        : keys_of_file(options, context);
  if (!file) return file.error();

  KeyShapes keys;
  keys.times = file->times;
  keys.join = file->join;
  if (options.between == Between::linear) keys.join = ShapeJoin::linear;
  if (options.between == Between::hermite) keys.join = ShapeJoin::hermite;
  keys.tension = options.tension.value_or(file->tension);
  keys.rate = options.rate.value_or(file->rate.value_or(kUsualRate));
  if (options.tension && keys.join == ShapeJoin::linear) {
    return Error("usage", "--tension is for --between hermite");
  }

  const std::string folder = is_folder ? path : path == "-" ? "" : folder_of(path);
  UniqueNames names;
  std::map<std::string, int> known;
  for (const std::string& name : file->shapes) {
    const auto [place, made] = known.emplace(name, static_cast<int>(known.size()));
    keys.shape_of.push_back(place->second);
    if (!made) continue;
    auto where = path_inside(folder, name);
    if (!where) return std::move(where).error().in_file(path);
    auto shape = read_shape(*where, options, context);
    if (!shape) return shape.error();
    if (Status status = add_shape(*std::move(shape), options, keys); !status) return status.error();
    const std::string whole = base_name(name);
    const std::string stem = to_utf8(whole.substr(0, whole.size() - extension(whole).size()));
    keys.shapes.names.push_back(names.make(stem.empty() ? "shape" : stem));
  }
  return keys;
}

constexpr double kMaxFrames = 10e6;
constexpr double kMaxWeights = 100e6;

Result<int> frame_count(const KeyShapes& keys) {
  const double frames = std::ceil(keys.times.back() * keys.rate - 1e-6) + 1;
  if (frames <= kMaxFrames &&
      frames * static_cast<double>(keys.shapes.names.size()) <= kMaxWeights) {
    return static_cast<int>(frames);
  }
  return Error("morph-too-large", fmt::format("{} s at {} fps are too many frames",
                                              readable(keys.times.back()), readable(keys.rate)));
}

// The weight of each shape in each frame; the weights of a frame sum to 1.
MorphWeights shares_of(const KeyShapes& keys, int frames) {
  MorphWeights weights;
  weights.rate = keys.rate;
  weights.names = keys.shapes.names;
  std::vector<double> row(weights.names.size());
  for (int frame = 0; frame < frames; ++frame) {
    std::ranges::fill(row, 0.0);
    const KeyShares shares = shares_at(keys.times, keys.join, keys.tension, frame / keys.rate);
    for (std::size_t i = 0; i < static_cast<std::size_t>(shares.count); ++i) {
      const auto key = static_cast<std::size_t>(shares.keys[i]);
      row[static_cast<std::size_t>(keys.shape_of[key])] += shares.shares[i];
    }
    for (const double share : row) weights.values.push_back(static_cast<float>(share));
  }
  return weights;
}

// The key-frame mesh with one shape per key.
KeyFrameMesh mesh_of(const KeyShapes& keys) {
  KeyFrameMesh mesh;
  mesh.times = keys.times;
  mesh.vertex_count = keys.shapes.vertex_count;
  for (const int shape : keys.shape_of) {
    const auto positions = keys.shapes.target_positions(shape);
    const auto normals = keys.shapes.target_normals(shape);
    mesh.positions.insert(mesh.positions.end(), positions.begin(), positions.end());
    mesh.normals.insert(mesh.normals.end(), normals.begin(), normals.end());
  }
  return mesh;
}

// Removes the first shape, which is the mesh itself, and its weights.
void leave_out_first(MorphSet& shapes, MorphWeights& weights) {
  const auto vertices = static_cast<std::ptrdiff_t>(shapes.vertex_count);
  const std::size_t targets = weights.names.size();
  shapes.positions.erase(shapes.positions.begin(), shapes.positions.begin() + vertices);
  shapes.normals.erase(shapes.normals.begin(), shapes.normals.begin() + vertices);
  shapes.names.erase(shapes.names.begin());
  std::vector<float> kept;
  for (std::size_t i = 0; i < weights.values.size(); ++i) {
    if (i % targets != 0) kept.push_back(weights.values[i]);
  }
  weights.values = std::move(kept);
  weights.names = shapes.names;
}

Status add_motion(KeyShapes& keys, int frames, MotionFormat format, As as, OutputSet& outputs,
                  ToolContext& context) {
  if (format == MotionFormat::exr) {
    keys.shapes.provenance = context.provenance();
    return outputs.add(context.output,
                       [&](OutputFile& file) { return morph_exr::write(keys.shapes, file); });
  }
  if (as == As::targets) {
    MorphWeights weights = shares_of(keys, frames);
    leave_out_first(keys.shapes, weights);
    return add_targets(keys.base, keys.shapes, weights, format, outputs, context);
  }
  const KeyFrameMesh mesh = mesh_of(keys);
  if (Status status = check(mesh); !status) return status;
  MeshMotion motion;
  motion.frames = frames;
  motion.rate = keys.rate;
  motion.source = copies_of([&](int frame, const ShapeOutput& to) {
    shape_at(mesh, keys.join, keys.tension, frame / keys.rate, {to.positions, to.normals}, 1);
  });
  return add_baked(keys.base, motion, format, outputs, context);
}

void report(const KeyShapes& keys, int frames, ToolContext& context) {
  Json result;
  result["vertices"] = keys.shapes.vertex_count;
  result["keys"] = keys.times.size();
  result["shapes"] = keys.shape_of.empty() ? 0 : *std::ranges::max_element(keys.shape_of) + 1;
  result["between"] = keys.join == ShapeJoin::linear ? "linear" : "hermite";
  result["tension"] = keys.tension;
  result["frames"] = frames;
  result["rate"] = keys.rate;
  context.report.result = std::move(result);
  context.log(fmt::format("{}: {}, {} at {} fps", context.output, counted(keys.times.size(), "key"),
                          counted(frames, "frame"), readable(keys.rate)));
}

}  // namespace

Result<int> frames(const Options& options, ToolContext& context) {
  const auto format = motion_format(context.output, true);
  if (!format) return format.error();
  const bool gltf = *format == MotionFormat::glb || *format == MotionFormat::gltf;
  if (options.as == As::targets && !gltf) {
    return Error("usage", "--as targets is for glTF");
  }
  auto keys = read_key_shapes(options, context);
  if (!keys) return keys.error();
  const auto count = frame_count(*keys);
  if (!count) return Error(count.error()).in_file(options.files[0]);

  OutputSet outputs(context);
  if (!options.save_weights.empty()) {
    const MorphWeights weights = shares_of(*keys, *count);
    const Status status = outputs.add(options.save_weights,
                                      [&](OutputFile& file) { return csv::write(weights, file); });
    if (!status) return status.error();
  }
  const Status status = add_motion(*keys, *count, *format, options.as, outputs, context);
  if (!status) return status.error();
  if (Status step = outputs.finish(); !step) return step.error();
  report(*keys, *count, context);
  return kExitDone;
}

}  // namespace krok::cli::morph
