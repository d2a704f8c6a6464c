#include <fmt/format.h>

#include "core/numbers.h"
#include "core/text.h"
#include "formats/timeline/fields_internal.h"
#include "formats/timeline/items_internal.h"
#include "formats/timeline/timeline_file.h"
#include "scene/frame_moment.h"

namespace krok::timeline_file {

namespace {

using json::Value;
using Kind = Value::Kind;

constexpr std::string_view kSchema = "krok.timeline/1";

class Reader {
 public:
  Reader(std::string_view text, const std::string& path)
      : text_(text), fields_(text), items_(text, path, fields_, names_, document_.timeline.rate) {}

  Result<Document> read() {
    const auto root = json::parse(text_);
    if (!root) return root.error();
    if (Status status =
            fields_.only(*root, kFile, {"schema", "comment", "rate", "sources", "base", "layers"});
        !status) {
      return status.error();
    }
    if (Status status = fields_.members().has_schema(*root, kFile, kSchema); !status) {
      return status.error();
    }
    for (const auto part :
         {&Reader::read_rate, &Reader::read_sources, &Reader::read_base, &Reader::read_layers}) {
      if (Status status = (this->*part)(*root); !status) return status.error();
    }
    return std::move(document_);
  }

 private:
  static constexpr std::string_view kFile = "the file";

  Status read_rate(const Value& root) {
    Taker take(root, kFile);
    take("rate", document_.timeline.rate, [&](const Field& field) -> Result<double> {
      auto rate = fields_.number(field);
      if (rate && (*rate < kMinRate || *rate > kMaxRate)) {
        return fields_.wrong(field, fmt::format("frames per second from {} to {}",
                                                readable(kMinRate), readable(kMaxRate)));
      }
      return rate;
    });
    return take.done();
  }

  Status read_sources(const Value& root) {
    const auto list = fields_.members().get(root, kFile, "sources", Kind::object);
    if (!list) return list.error();
    for (const Value::Member& member : (*list)->members) {
      auto source = read_source(member);
      if (!source) return source.error();
      names_.push_back(source->name);
      document_.sources.push_back(std::move(*source));
    }
    return {};
  }

  // A path, or an object.
  Result<SourceFile> read_source(const Value::Member& member) const {
    const std::string what = fmt::format("the source '{}'", shown(member.key));
    const Value& value = member.value;
    SourceFile source;
    source.name = member.key;
    source.where = items_.place_of(value);
    if (member.key.empty()) return fields_.members().wrong(value, "a source has no name");
    const auto name = [&](const Field& field) { return fields_.name(field); };
    if (value.kind == Kind::string) {
      auto path = name({&value, "file", what});
      if (!path) return path.error();
      source.path = std::move(*path);
      return source;
    }
    if (Status status = fields_.only(value, what, {"file", "sequences"}); !status) {
      return status.error();
    }
    const auto file = fields_.members().get(value, what, "file", Kind::string);
    if (!file) return file.error();
    Taker take(value, what);
    take("file", source.path, name)("sequences", source.sequences, name);
    if (Status status = take.done(); !status) return status.error();
    return source;
  }

  Status read_base(const Value& root) {
    const auto list = fields_.members().get(root, kFile, "base", Kind::array);
    if (!list) return list.error();
    auto& base = document_.timeline.base;
    return fields_.each(root, kFile, "base", [&](const Value& value) -> Status {
      auto item = items_.base_item(value, base.empty());
      if (!item) return item.error();
      base.push_back(std::move(*item));
      return {};
    });
  }

  Status read_layers(const Value& root) {
    auto& layers = document_.timeline.layers;
    return fields_.each(root, kFile, "layers", [&](const Value& value) -> Status {
      auto layer = items_.layer(value, layers.size() + 1);
      if (!layer) return layer.error();
      layers.push_back(std::move(*layer));
      return {};
    });
  }

  std::string_view text_;
  Fields fields_;
  Document document_;
  std::vector<std::string> names_;
  Items items_;
};

}  // namespace

Result<Document> read(std::string_view text, const std::string& path) {
  auto document = Reader(text, path).read();
  if (!document) return std::move(document).error().in_file(path);
  return document;
}

}  // namespace krok::timeline_file
