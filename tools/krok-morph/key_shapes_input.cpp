#include "tools/krok-morph/key_shapes_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <tuple>

#include "capture/unique_names.h"
#include "core/numbers.h"
#include "core/path_inside.h"
#include "core/quantity.h"
#include "core/text.h"

namespace krok::cli::morph {

namespace {

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

}  // namespace

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

}  // namespace krok::cli::morph
