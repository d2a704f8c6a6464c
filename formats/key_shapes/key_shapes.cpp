#include "formats/key_shapes/key_shapes.h"

#include "formats/json/fields.h"

namespace krok::key_shapes {

namespace {

using json::Given;

struct Key {
  double time = 0;
  std::string shape;
};

struct File {
  KeyShapeFile read = {};
  std::vector<Key> keys = {};

  json::Object<File> table() {
    json::Object<Key> key;
    key.field("time", &Key::time, json::moment(read.rate, 1e6)).required();
    key.field("shape", &Key::shape, json::path(), "path of the mesh").required().comment();
    json::Object<File> file;
    file.file("krok.key-shapes/1", "Key frames of a mesh (krok.key-shapes/1)").comment();
    file.context("rate", read.rate, json::frame_rate(), "frames per second of the result");
    file.context(
        "between", read.join,
        json::choice<ShapeJoin>({{"linear", ShapeJoin::linear}, {"hermite", ShapeJoin::hermite}}));
    file.context("tension", read.tension, json::number(0, 1));
    file.context("keys", keys,
                 json::list<Key>(json::object(key),
                                 {"key {0}", 1, 100'000, "{0} keys, expected 1 to 100,000"},
                                 json::times_increase<Key>))
        .required();
    return file;
  }
};

}  // namespace

Result<KeyShapeFile> read(std::string_view text) {
  File file;
  if (const auto status = file.table().read_text(text, "key-shapes"); !status) {
    return status.error();
  }
  for (Key& key : file.keys) {
    file.read.times.push_back(key.time);
    file.read.shapes.push_back(std::move(key.shape));
  }
  return std::move(file.read);
}

std::string schema() {
  return File().table().schema();
}

}  // namespace krok::key_shapes
