#include "formats/obj/obj_writer.h"
#include "core/text.h"
#include "math/vector_arrays.h"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <map>
#include <set>

namespace krok::obj {

namespace {

// The longest text of a float, "-1.17549435e-38", and a space.
constexpr std::size_t kNumberRoom = 16;
constexpr std::size_t kLineRoom = 3 + 3 * kNumberRoom;
constexpr std::size_t kWrittenAtOnce = std::size_t{1} << 18;

// A text buffer that is flushed when it is long enough.
class Lines {
 public:
  explicit Lines(OutputFile& file) : file_(file), text_(kWrittenAtOnce, '\0') {}

  // "v 1 2 3"
  Status add(std::string_view keyword, const Vec3f& vector) {
    if (used_ + kLineRoom > text_.size()) {
      if (Status status = flush(); !status) return status;
    }
    char* at = std::copy(keyword.begin(), keyword.end(), text_.data() + used_);
    for (const float value : vector) {
      *at++ = ' ';
      at = std::to_chars(at, at + kNumberRoom, value).ptr;
    }
    *at++ = '\n';
    used_ = static_cast<std::size_t>(at - text_.data());
    return {};
  }

  Status flush() {
    const auto used = std::exchange(used_, 0);
    return file_.write(std::string_view(text_).substr(0, used));
  }

 private:
  OutputFile& file_;
  std::string text_;
  std::size_t used_ = 0;
};

Status add_all(Lines& lines, std::string_view keyword, std::span<const Vec3f> vectors) {
  for (const Vec3f& vector : vectors) {
    if (Status status = lines.add(keyword, vector); !status) return status;
  }
  return {};
}

// Makes names of one kind valid and unique.
class Names {
 public:
  const std::string& operator()(const std::string& name) {
    const auto [place, is_new] = written_.try_emplace(name);
    if (is_new) place->second = unique(usable(name));
    return place->second;
  }

 private:
  // Spaces and control characters end a name, a backslash joins lines, '#' begins a comment.
  static std::string usable(std::string name) {
    std::ranges::replace_if(
        name,
        [](char c) {
          return static_cast<unsigned char>(c) <= ' ' || c == 0x7F || c == '\\' || c == '#';
        },
        '_');
    return name.empty() ? "default" : printable(name);
  }

  std::string unique(const std::string& wanted) {
    std::string name = wanted;
    for (int i = 2; !taken_.insert(name).second; ++i) name = fmt::format("{}_{}", wanted, i);
    return name;
  }

  std::map<std::string, std::string> written_;
  std::set<std::string> taken_;
};

std::string head_text(const WriteOptions& options) {
  std::string text;
  if (!options.provenance.tool.empty()) {
    text = fmt::format("# {} {}\n", options.provenance.tool, options.provenance.version);
  }
  Names names;
  return text + "# metres, +Y up\no " + names(options.name) + "\n";
}

// In OBJ, v is up.
std::string coordinates_text(std::span<const Vec2f> coordinates) {
  std::string text;
  for (const Vec2f& uv : coordinates) {
    fmt::format_to(std::back_inserter(text), FMT_COMPILE("vt {} {}\n"), uv.x(), 1.0f - uv.y());
  }
  return text;
}

// "f 1/1/1 2/2/2 3/3/3": indices of position, texture coordinate and normal.
void add_face(std::string& text, const std::array<std::uint32_t, 3>& triangle, bool coordinates,
              bool normals) {
  const auto out = std::back_inserter(text);
  text += 'f';
  for (const std::uint32_t corner : triangle) {
    const std::uint64_t index = std::uint64_t{corner} + 1;
    fmt::format_to(out, FMT_COMPILE(" {}"), index);
    if (coordinates) fmt::format_to(out, FMT_COMPILE("/{}"), index);
    if (normals) fmt::format_to(out, FMT_COMPILE("{}{}"), coordinates ? "/" : "//", index);
  }
  text += '\n';
}

std::string faces_text(const Model& model) {
  const auto is_named = [](const Model::Part& part) { return !part.name.empty(); };
  const auto has_material = [](const Model::Part& part) { return !part.material.empty(); };
  const bool named = std::ranges::any_of(model.parts, is_named);
  const bool materials = std::ranges::any_of(model.parts, has_material);
  Names groups, surfaces;
  std::string text;
  for (const Model::Part& part : model.parts) {
    if (part.triangle_count == 0) continue;
    if (named) text += "g " + groups(part.name) + "\n";
    if (materials) text += "usemtl " + surfaces(part.material) + "\n";
    for (std::uint32_t t = 0; t < part.triangle_count; ++t) {
      add_face(text, model.triangles[part.first_triangle + t], !model.texture_coordinates.empty(),
               !model.normals.empty());
    }
  }
  return text;
}

}  // namespace

Result<Writer> Writer::create(const Model& model, const WriteOptions& options) {
  if (Status status = check(model); !status) return status.error();
  if (model.triangles.empty()) {
    return Error("obj-empty-mesh", "the model has no triangles");
  }
  Writer writer;
  writer.vertices_ = model.positions.size();
  writer.normals_ = !model.normals.empty();
  writer.head_ = head_text(options);
  writer.texture_coordinates_ = coordinates_text(model.texture_coordinates);
  writer.faces_ = faces_text(model);
  return writer;
}

Status Writer::write(const MeshShape& shape, OutputFile& file) const {
  const std::size_t normals = normals_ ? vertices_ : 0;
  if (shape.positions.size() != vertices_ || shape.normals.size() != normals) {
    return Error(
        "obj-shape",
        fmt::format("the shape has {} positions and {} normals, but the model has {} and {}",
                    shape.positions.size(), shape.normals.size(), vertices_, normals));
  }
  if (!all_finite(shape.positions) || !all_finite(shape.normals)) {
    return Error("obj-shape", "a vertex is not finite");
  }
  if (Status status = file.write(head_); !status) return status;
  Lines lines(file);
  if (Status status = add_all(lines, "v", shape.positions); !status) return status;
  if (Status status = lines.flush(); !status) return status;
  if (Status status = file.write(texture_coordinates_); !status) return status;
  if (Status status = add_all(lines, "vn", shape.normals); !status) return status;
  if (Status status = lines.flush(); !status) return status;
  return file.write(faces_);
}

Status write(const Model& model, const MeshShape& shape, const WriteOptions& options,
             OutputFile& file) {
  const auto writer = Writer::create(model, options);
  return writer ? writer->write(shape, file) : Status(writer.error());
}

}  // namespace krok::obj
