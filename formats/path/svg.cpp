#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/text.h"
#include "formats/path/path_data_internal.h"

namespace krok::path_file {

namespace {

constexpr std::size_t kDeepest = 256;  // elements within elements

// A start or end tag.
struct Tag {
  std::string_view name;  // without a prefix
  bool ends = false;      // </name>
  bool empty = false;     // <name/>
  // Of these attributes, the values as written, and where they begin.
  std::string_view d, points, id, transform;
  std::size_t d_at = 0, points_at = 0, transform_at = 0;
};

std::string_view local_name(std::string_view name) {
  const std::size_t colon = name.find(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

// Walks over the tags of an XML text; everything else is left out.
class TagScanner {
 public:
  explicit TagScanner(std::string_view text) : text_(text) {}

  std::size_t offset() const { return at_; }

  // False at the end, and at what is no XML: then broken() is true.
  bool next(Tag& tag) {
    while (true) {
      at_ = text_.find('<', at_);
      if (at_ == std::string_view::npos) return false;
      const std::string_view rest = text_.substr(at_);
      if (rest.starts_with("<!--")) {
        if (!skip_past("-->")) return false;
      } else if (rest.starts_with("<![CDATA[")) {
        if (!skip_past("]]>")) return false;
      } else if (rest.starts_with("<?")) {
        if (!skip_past("?>")) return false;
      } else if (rest.starts_with("<!")) {
        if (!skip_past(">")) return false;
      } else {
        return read(tag);
      }
    }
  }
  bool broken() const { return broken_; }

 private:
  bool skip_past(std::string_view end) {
    const std::size_t found = text_.find(end, at_);
    if (found == std::string_view::npos) return !(broken_ = true);
    at_ = found + end.size();
    return true;
  }

  bool read(Tag& tag) {
    tag = {};
    std::size_t at = at_ + 1;
    const auto fail = [&] { return !(broken_ = true); };
    const auto space = [&] {
      while (at < text_.size() && is_space(text_[at])) ++at;
    };
    const auto word = [&] {
      const std::size_t begin = at;
      while (at < text_.size() && !is_space(text_[at]) &&
             std::string_view("=/><").find(text_[at]) == std::string_view::npos) {
        ++at;
      }
      return local_name(text_.substr(begin, at - begin));
    };
    if (at < text_.size() && text_[at] == '/') {
      tag.ends = true;
      ++at;
    }
    tag.name = word();
    if (tag.name.empty()) return fail();
    while (true) {
      space();
      if (at >= text_.size()) return fail();
      if (text_[at] == '>') break;
      if (text_[at] == '/') {
        tag.empty = true;
        ++at;
        continue;
      }
      const std::string_view name = word();
      space();
      if (name.empty() || at >= text_.size() || text_[at] != '=') return fail();
      ++at;
      space();
      if (at >= text_.size() || (text_[at] != '"' && text_[at] != '\'')) return fail();
      const std::size_t begin = at + 1, end = text_.find(text_[at], begin);
      if (end == std::string_view::npos) return fail();
      keep(tag, name, text_.substr(begin, end - begin), begin);
      at = end + 1;
    }
    at_ = at + 1;
    return true;
  }

  static void keep(Tag& tag, std::string_view name, std::string_view value, std::size_t at) {
    if (name == "d") tag.d = value, tag.d_at = at;
    if (name == "points") tag.points = value, tag.points_at = at;
    if (name == "id") tag.id = value;
    if (name == "transform") tag.transform = value, tag.transform_at = at;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  bool broken_ = false;
};

Error svg_error(const DataFault& fault, std::size_t begin, std::size_t& place) {
  place = begin + fault.offset;
  return {fault.code, fault.message};
}

}  // namespace

std::optional<DataFault> read_transform(std::string_view text, Affine2& transform) {
  NumberScanner in(text);
  transform = Affine2::Identity();
  while (!in.at_end()) {
    const std::size_t begin = in.offset();
    while (in.peek() != '(' && in.offset() < text.size()) in.take();
    const std::string_view name = trimmed(text.substr(begin, in.offset() - begin));
    if (in.offset() >= text.size()) return DataFault{begin, "a transform has no brackets"};
    in.take();
    std::array<double, 6> v{};
    std::size_t count = 0;
    in.skip_space();
    while (in.peek() != ')') {
      const auto value = count < v.size() ? in.number() : std::nullopt;
      if (!value) return DataFault{in.offset(), "a transform has something else than numbers"};
      v[count++] = *value;
      in.skip_comma();
    }
    in.take();
    Affine2 one = Affine2::Identity();
    if (name == "translate" && (count == 1 || count == 2)) {
      one.translate(Vec2(v[0], v[1]));
    } else if (name == "scale" && (count == 1 || count == 2)) {
      one.scale(Vec2(v[0], count == 1 ? v[0] : v[1]));
    } else if (name == "rotate" && (count == 1 || count == 3)) {
      one.translate(Vec2(v[1], v[2]));
      one.rotate(v[0] * kRadiansPerDegree);
      one.translate(-Vec2(v[1], v[2]));
    } else if (name == "skewX" && count == 1) {
      one.linear()(0, 1) = std::tan(v[0] * kRadiansPerDegree);
    } else if (name == "skewY" && count == 1) {
      one.linear()(1, 0) = std::tan(v[0] * kRadiansPerDegree);
    } else if (name == "matrix" && count == 6) {
      one.linear() << v[0], v[2], v[1], v[3];
      one.translation() << v[4], v[5];
    } else {
      return DataFault{begin,
                       fmt::format("'{}' with {} numbers is no transform", shown(name), count)};
    }
    transform = transform * one;
    in.skip_comma();
  }
  return {};
}

Result<std::vector<Vec2>> read_svg(std::string_view text, double metres_per_unit,
                                   const std::string& id, std::size_t& fault_place) {
  TagScanner tags(text);
  Affine2 base = Affine2::Identity();
  base.scale(metres_per_unit);
  std::vector<Affine2> transforms = {base};  // of the open elements
  std::size_t hidden = 0;                    // how deep in what is not drawn
  std::size_t others = 0;
  Tag tag;
  while (tags.next(tag)) {
    if (tag.ends) {
      if (transforms.size() > 1) transforms.pop_back();
      if (hidden > 0) --hidden;
      continue;
    }
    Affine2 own = Affine2::Identity();
    if (auto fault = read_transform(tag.transform, own)) {
      return svg_error(*fault, tag.transform_at, fault_place);
    }
    const Affine2 to_metres = transforms.back() * own;
    const bool not_drawn = tag.name == "defs" || tag.name == "clipPath" || tag.name == "symbol" ||
                           tag.name == "marker" || tag.name == "mask" || tag.name == "pattern";
    const bool is_path = tag.name == "path" && !tag.d.empty();
    const bool is_line = tag.name == "polyline" && !tag.points.empty();
    if (is_path || is_line) ++others;
    if ((is_path || is_line) && (id.empty() ? hidden == 0 : tag.id == id)) {
      std::vector<Vec2> points;
      const auto fault = is_path ? read_path_data(tag.d, to_metres, points)
                                 : read_polyline(tag.points, to_metres, points);
      if (fault) return svg_error(*fault, is_path ? tag.d_at : tag.points_at, fault_place);
      return points;
    }
    if (tag.empty) continue;
    if (transforms.size() >= kDeepest) {
      fault_place = tags.offset();
      return Error("path-svg", "elements are nested too deeply");
    }
    transforms.push_back(to_metres);
    if (hidden > 0 || not_drawn) ++hidden;
  }
  fault_place = tags.broken() ? tags.offset() : 0;
  if (tags.broken()) return Error("path-svg", "the file is no well-formed XML from here on");
  if (!id.empty()) {
    return Error("path-svg",
                 fmt::format("no path or polyline has the id '{}' (of {})", shown(id), others));
  }
  return Error("path-svg", "the file draws no path and no polyline",
               "convert the shape to a path in the drawing program");
}

}  // namespace krok::path_file
