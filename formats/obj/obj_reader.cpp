#include "formats/obj/obj_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "core/numbers.h"
#include "core/text.h"

namespace krok::obj {

namespace {

constexpr std::size_t kMaxParts = 65'536;
constexpr std::size_t kMaxElements = std::numeric_limits<std::int32_t>::max();

// Free-form geometry and display statements, which are ignored.
constexpr std::array kPassedOver = {"s",        "mtllib",     "vp",       "lod",
                                    "bevel",    "maplib",     "usemap",   "c_interp",
                                    "d_interp", "shadow_obj", "trace_obj"};
constexpr std::array kLeftOut = {"p",    "l",    "curv", "curv2", "surf",  "cstype", "deg",
                                 "bmat", "step", "parm", "trim",  "hole",  "scrv",   "sp",
                                 "end",  "con",  "mg",   "ctech", "stech", "call",   "csh"};

// A corner of a face: 0-based indices in the file's lists, -1 for none.
struct Corner {
  long long position = -1, texture = -1, normal = -1;
};

class Reader {
 public:
  Reader(std::string_view text, const std::string& path, const ReadOptions& options)
      : text_(without_byte_order_mark(text)), path_(path), scale_(options.metres_per_unit) {}

  Result<Shape> read() {
    while (next_statement()) {
      if (words_.empty()) continue;
      if (Status status = read_statement(); !status) return status.error();
    }
    return finish();
  }

 private:
  // Splits the next line into words, with continuation lines (backslash), without comments. False
  // at the end.
  bool next_statement() {
    words_.clear();
    if (at_ >= text_.size()) return false;
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (is_line_end(c)) {
        ++at_;
        break;
      }
      if (c == '#') {
        at_ = std::min(text_.find_first_of("\r\n", at_), text_.size());
      } else if (c == '\\' && at_ + 1 < text_.size() && is_line_end(text_[at_ + 1])) {
        at_ += text_[at_ + 1] == '\r' && at_ + 2 < text_.size() && text_[at_ + 2] == '\n' ? 3 : 2;
      } else if (is_space(c)) {
        ++at_;
      } else {
        const std::size_t begin = at_;
        while (at_ < text_.size() && !is_space(text_[at_]) && text_[at_] != '#') {
          if (text_[at_] == '\\' && at_ + 1 < text_.size() && is_line_end(text_[at_ + 1])) break;
          ++at_;
        }
        words_.push_back(text_.substr(begin, at_ - begin));
      }
    }
    return true;
  }

  Error fault(const char* code, std::string_view word, std::string message,
              std::string hint = {}) const {
    Error error(code, std::move(message), std::move(hint));
    error.where = locate(text_, static_cast<std::size_t>(word.data() - text_.data()), path_);
    return error;
  }

  Status read_statement() {
    const std::string_view kind = words_[0];
    if (kind == "v") return read_numbers(3, positions_, scale_);
    if (kind == "vn") return read_numbers(3, normals_, 1);
    if (kind == "vt") return read_texture();
    if (kind == "f" || kind == "fo") return read_face();
    if (kind == "o" || kind == "g" || kind == "usemtl") {
      // Names may have spaces.
      std::string name = words_.size() < 2 ? std::string() : rest_of_line(words_[1]);
      (kind == "usemtl" ? material_ : name_) = to_utf8(name);
      new_part_ = true;
      return {};
    }
    if (std::ranges::find(kPassedOver, kind) != kPassedOver.end()) return {};
    if (std::ranges::find(kLeftOut, kind) != kLeftOut.end()) {
      left_out_.emplace(kind);
      return {};
    }
    return fault("obj-text", kind, fmt::format("'{}' is not an OBJ statement", shown(kind)));
  }

  std::string rest_of_line(std::string_view first) const {
    const std::string_view& last = words_.back();
    return std::string(first.data(), last.data() + last.size());
  }

  Result<float> number(std::size_t word, double scale) const {
    const std::string_view kind = words_[0];
    if (word >= words_.size()) {
      return fault("obj-number", kind,
                   fmt::format("'{}' has {}", kind,
                               counted(static_cast<long long>(words_.size()) - 1, "number")));
    }
    const auto value = parse_finite(words_[word]);
    if (!value) {
      return fault("obj-number", words_[word],
                   fmt::format("'{}' is not a number", shown(words_[word])));
    }
    const auto result = static_cast<float>(*value * scale);
    if (std::isfinite(result)) return result;
    return fault("obj-number", words_[word],
                 fmt::format("{} is out of range", shown(words_[word])));
  }

  // More numbers (a weight, a colour) are ignored.
  Status read_numbers(std::size_t count, std::vector<Vec3f>& list, double scale) {
    Vec3f values;
    for (std::size_t i = 0; i < count; ++i) {
      const auto value = number(i + 1, scale);
      if (!value) return value.error();
      values[static_cast<Eigen::Index>(i)] = *value;
    }
    return append(list, values);
  }

  template <typename Value>
  Status append(std::vector<Value>& list, const Value& value) {
    if (list.size() == kMaxElements) {
      return fault("obj-limit", words_[0], "too many of these statements");
    }
    list.push_back(value);
    return {};
  }

  Status read_texture() {
    const auto u = number(1, 1);
    if (!u) return u.error();
    const auto v = words_.size() > 2 ? number(2, 1) : Result<float>(0.0f);
    if (!v) return v.error();
    return append(textures_, Vec2f(*u, 1 - *v));
  }

  // An index in a list of `count` so far: 1-based, or relative to the end if negative.
  Result<long long> place(std::string_view word, std::string_view part, std::size_t count,
                          const char* what) const {
    const auto index = parse_integer(part);
    if (!index || *index == 0) {
      return fault("obj-index", word, fmt::format("'{}' has no index of a {}", shown(word), what),
                   "a corner is V, V/T, V//N or V/T/N; indices begin at 1");
    }
    const long long found = *index > 0 ? *index - 1 : static_cast<long long>(count) + *index;
    if (found >= 0 && found < static_cast<long long>(count)) return found;
    return fault(
        "obj-index", word,
        fmt::format("'{}' refers to {} {}, of {} so far", shown(word), what, *index, count));
  }

  Result<Corner> corner(std::string_view word) const {
    Corner result;
    std::array<std::string_view, 3> parts;
    std::string_view rest = word;
    std::size_t count = 0;
    for (bool more = true; more; ++count) {
      const std::size_t slash = rest.find('/');
      more = slash != std::string_view::npos;
      if (count == 3)
        return fault("obj-index", word, fmt::format("'{}' has too many parts", shown(word)));
      parts[count] = rest.substr(0, slash);
      rest = more ? rest.substr(slash + 1) : std::string_view();
    }
    const auto vertex = place(word, parts[0], positions_.size(), "vertex");
    if (!vertex) return vertex.error();
    result.position = *vertex;
    if (!parts[1].empty()) {
      const auto texture = place(word, parts[1], textures_.size(), "texture coordinate");
      if (!texture) return texture.error();
      result.texture = *texture;
    }
    if (!parts[2].empty()) {
      const auto normal = place(word, parts[2], normals_.size(), "normal");
      if (!normal) return normal.error();
      result.normal = *normal;
    }
    return result;
  }

  Status read_face() {
    if (words_.size() < 4) {
      return fault("obj-face", words_[0],
                   fmt::format("a face has {}, expected 3 or more",
                               counted(static_cast<long long>(words_.size()) - 1, "corner")));
    }
    if (Status status = begin_part(); !status) return status;
    Model& model = shape_.model;
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t i = 1; i < words_.size(); ++i) {
      const auto found = corner(words_[i]);
      if (!found) return found.error();
      corners_.push_back(*found);
      const auto vertex = static_cast<std::uint32_t>(found->position);
      if (i == 1) triangle[0] = vertex;
      triangle[1] = triangle[2];
      triangle[2] = vertex;
      if (i < 3) continue;
      if (Status status = append(model.triangles, triangle); !status) return status;
      ++model.parts.back().triangle_count;
    }
    take_corners();
    return {};
  }

  // A part begins with its first face, so that no part is empty.
  Status begin_part() {
    if (!new_part_) return {};
    new_part_ = false;
    Model& model = shape_.model;
    if (model.parts.size() == kMaxParts) {
      return fault("obj-limit", words_[0],
                   fmt::format("the file has more than {} groups", grouped(kMaxParts)));
    }
    model.parts.push_back(
        {name_, material_, static_cast<std::uint32_t>(model.triangles.size()), 0});
    return {};
  }

  // Takes normals and texture coordinates from the corners of a face.
  void take_corners() {
    Model& model = shape_.model;
    for (const Corner& one : corners_) {
      const auto vertex = static_cast<std::size_t>(one.position);
      take_normal(one, vertex);
      if (one.texture < 0) continue;
      if (texture_of_.size() <= vertex) texture_of_.resize(positions_.size(), -1);
      long long& first = texture_of_[vertex];
      if (first < 0) first = one.texture;
      const auto same = [&](long long a, long long b) {
        return textures_[static_cast<std::size_t>(a)] == textures_[static_cast<std::size_t>(b)];
      };
      if (first != one.texture && !same(first, one.texture)) ++several_textures_;
    }
    corners_.clear();
    all_normals_ = all_normals_ && !model.triangles.empty();
  }

  void take_normal(const Corner& one, std::size_t vertex) {
    if (one.normal < 0) {
      all_normals_ = false;
      return;
    }
    if (first_normal_.size() <= vertex) {
      first_normal_.resize(positions_.size(), -1);
      normal_sums_.resize(positions_.size(), Vec3::Zero());
      mixed_.resize(positions_.size(), 0);
    }
    const Vec3f& normal = normals_[static_cast<std::size_t>(one.normal)];
    const double length = normal.cast<double>().norm();
    if (length > 1e-15) normal_sums_[vertex] += normal.cast<double>() / length;
    long long& first = first_normal_[vertex];
    if (first < 0) first = one.normal;
    if (normals_[static_cast<std::size_t>(first)] != normal) mixed_[vertex] = 1;
  }

  Vec3f normal_at(std::size_t vertex) const {
    if (vertex >= first_normal_.size() || first_normal_[vertex] < 0) return Vec3f::UnitY();
    const Vec3f& first = normals_[static_cast<std::size_t>(first_normal_[vertex])];
    // A unit normal is kept exactly.
    if (mixed_[vertex] == 0 && std::abs(first.norm() - 1) < 1e-4f) return first;
    const double length = normal_sums_[vertex].norm();
    if (!(length > 1e-9)) return Vec3f::UnitY();
    return (normal_sums_[vertex] / length).cast<float>();
  }

  void warn(const char* code, std::string message) {
    shape_.diagnostics.push_back(make_warning(code, std::move(message), "", path_));
  }

  Result<Shape> finish() {
    Model& model = shape_.model;
    const std::size_t count = positions_.size();
    if (count == 0) {
      return Error("obj-empty", "the file has no vertices",
                   "OBJ files have vertices in lines 'v x y z'")
          .in_file(path_);
    }
    if (all_normals_ && !model.triangles.empty()) {
      model.normals.resize(count);
      for (std::size_t v = 0; v < count; ++v) model.normals[v] = normal_at(v);
    }
    if (!texture_of_.empty()) {
      model.texture_coordinates.assign(count, Vec2f::Zero());
      for (std::size_t v = 0; v < texture_of_.size(); ++v) {
        if (texture_of_[v] < 0) continue;
        model.texture_coordinates[v] = textures_[static_cast<std::size_t>(texture_of_[v])];
      }
    }
    model.positions = std::move(positions_);
    model.skeleton.add("root", Skeleton::kNoParent, {});
    model.influences_per_vertex = 1;
    model.influence_joints.assign(count, 0);
    model.influence_weights.assign(count, 1.0f);
    if (!left_out_.empty()) {
      warn("obj-left-out",
           fmt::format("left out, as only polygons are read: {}", fmt::join(left_out_, ", ")));
    }
    if (several_textures_ > 0) {
      warn("obj-several",
           fmt::format("at {} a vertex has another texture coordinate than at its first corner; "
                       "the first is used",
                       counted(several_textures_, "corner")));
    }
    if (Status status = check(model); !status) return std::move(status).error().in_file(path_);
    return std::move(shape_);
  }

  std::string_view text_;
  const std::string& path_;
  double scale_;
  std::size_t at_ = 0;
  std::vector<std::string_view> words_;

  std::vector<Vec3f> positions_, normals_;
  std::vector<Vec2f> textures_;
  std::vector<Corner> corners_;
  std::string name_, material_;
  bool new_part_ = true;

  // For each vertex used so far: indices of its first normal and texture coordinate, the sum of its
  // normals, and whether they differ.
  std::vector<long long> first_normal_, texture_of_;
  std::vector<Vec3> normal_sums_;
  std::vector<std::uint8_t> mixed_;
  bool all_normals_ = true;
  long long several_textures_ = 0;
  std::set<std::string> left_out_;
  Shape shape_;
};

}  // namespace

Result<Shape> read(std::string_view text, const std::string& path, const ReadOptions& options) {
  return Reader(text, path, options).read();
}

}  // namespace krok::obj
