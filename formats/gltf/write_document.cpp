#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <charconv>
#include <sstream>

#include "core/json_internal.h"
#include "core/text.h"
#include "formats/gltf/document_internal.h"
#include "formats/gltf/gltf_writer.h"

namespace krok::gltf {

namespace {

// Placeholder for a bound that is not known yet. No float has this value, and its text is as long
// as that of the longest float; shorter ones are padded, as JSON allows white space after numbers.
constexpr double kUnknown = -1.2345678e-300;
constexpr std::string_view kRoom = "-1.2345678e-300";

static_assert(std::endian::native == std::endian::little, "glTF's numbers are");

// Offset of the JSON in a GLB.
constexpr std::size_t kJsonBegin = 20;

// A multiple of three: base64 encodes three bytes as four characters.
constexpr std::size_t kEncodedAtOnce = std::size_t{48} << 10;

void replace_room(std::string& text, std::size_t& at, float value) {
  at = text.find(kRoom, at);
  assert(at != std::string::npos);
  char* const begin = text.data() + at;
  char* const end = begin + kRoom.size();
  std::fill(std::to_chars(begin, end, value).ptr, end, ' ');
  at += kRoom.size();
}

}  // namespace

int Document::promise_floats(std::size_t count, int type, Use use) {
  const auto components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type));
  const std::size_t bytes = count * static_cast<std::size_t>(components) * sizeof(float);
  const int accessor =
      add_accessor_of(bytes, TINYGLTF_COMPONENT_TYPE_FLOAT, sizeof(float), type, use);
  size_ += bytes;
  promised_ += bytes;
  return accessor;
}

int Document::promise_positions(std::size_t count) {
  const int index = promise_floats(count, TINYGLTF_TYPE_VEC3, Use::vertices);
  auto& accessor = gltf.accessors[static_cast<std::size_t>(index)];
  accessor.minValues.assign(3, kUnknown);
  accessor.maxValues.assign(3, kUnknown);
  ++bounds_;
  return index;
}

Status Document::write(OutputFile& file) {
  assert(promised_ == 0);
  const bool compressed = options_.compressed && options_.binary && size_ > 0;
  const bool in_place = options_.binary && !compressed && file.can_overwrite();
  if (!in_place) {
    if (Status status = read_keys(nullptr); !status) return status;
  }
  if (compressed) return write_compressed(file);
  if (Status status = begin(file); !status) return status;
  if (in_place) {
    if (Status status = read_keys(&file); !status) return status;
  }
  return end({});
}

Status Document::read_keys(OutputFile* file) {
  const auto put = [&](const KeyPlace& to, std::size_t first,
                       std::span<const std::byte> bytes) -> Status {
    if (file != nullptr) return file->overwrite(data_begin_ + to.offset + first, bytes);
    Part& part = parts_[to.part];
    part.own.resize(part.to_read);
    std::ranges::copy(bytes, part.own.begin() + static_cast<std::ptrdiff_t>(first));
    return {};
  };
  for (const PromisedKeys& keys : promised_keys_) {
    Status status = keys.tracks->read([&](std::size_t joint, std::size_t first,
                                          std::span<const Vec3f> translations,
                                          std::span<const Quatf> rotations) -> Status {
      if (!translations.empty()) {
        Status moved =
            put(keys.translations[joint], first * sizeof(Vec3f), std::as_bytes(translations));
        if (!moved) return moved;
      }
      if (rotations.empty()) return {};
      return put(keys.rotations[joint], first * sizeof(Quatf), std::as_bytes(rotations));
    });
    if (!status) return status;
  }
  return {};
}

Status Document::begin(OutputFile& file, std::span<const Bounds> bounds) {
  if (size_ > kMaxDataBytes) {
    return Error("gltf-too-large",
                 fmt::format("the file would have {} MB, which exceeds glTF's limit", size_ >> 20),
                 "write fewer frames");
  }
  file_ = &file;
  try {
    json_ = json_text();
  } catch (const nlohmann::json::exception&) {
    // The serializer throws only for invalid UTF-8.
    return Error("gltf-name", "a name is not valid UTF-8, which glTF requires",
                 "rename the joint or material");
  }
  fill_in(bounds);
  if (Status status = options_.binary ? begin_binary() : begin_text(); !status) return status;
  data_begin_ = file.size();
  const std::vector<std::byte> zeros(std::size_t{1} << 20);
  for (const Part& part : parts_) {
    if (Status status = append(part.bytes()); !status) return status;
    // Keys that are read later overwrite these.
    for (std::size_t left = part.own.empty() ? part.to_read : 0; left > 0;) {
      const std::size_t count = std::min(left, zeros.size());
      if (Status status = append(std::span(zeros).first(count)); !status) return status;
      left -= count;
    }
  }
  return {};
}

// Written without the buffer, which tinygltf would copy twice.
std::string Document::json_text() const {
  std::ostringstream stream;
  tinygltf::TinyGLTF().WriteGltfSceneToStream(const_cast<tinygltf::Model*>(&gltf), stream,
                                              !options_.binary, false);
  std::string text = with_escaped_controls(stream.str());
  text.pop_back();  // the newline
  if (size_ == 0 || !options_.binary) return text;
  // Insert in alphabetical order, after the buffer views, which contain no other list.
  const std::size_t views = text.find("\"bufferViews\":[");
  assert(views != std::string::npos);
  text.insert(text.find(']', views) + 1,
              fmt::format(",\"buffers\":[{{\"byteLength\":{}}}]", size_));
  return text;
}

// The JSON has its keys in alphabetical order: `max` comes before `min`.
void Document::fill_in(std::span<const Bounds> bounds) {
  std::size_t at = 0;
  for (const Bounds& bound : bounds) {
    for (const float value : bound.most) replace_room(json_, at, value);
    for (const float value : bound.least) replace_room(json_, at, value);
  }
  bounds_ -= bounds.size();
}

Status Document::begin_binary() {
  constexpr std::uint32_t kMagic = 0x46546C67, kJson = 0x4E4F534A, kBinary = 0x004E4942;
  json_.resize((json_.size() + 3) / 4 * 4, ' ');
  const auto json_size = static_cast<std::uint32_t>(json_.size());
  const auto data_size = static_cast<std::uint32_t>(size_);
  const std::uint32_t data_chunk = size_ > 0 ? 8 + data_size : 0;
  const std::array<std::uint32_t, 5> head = {kMagic, 2, 12 + 8 + json_size + data_chunk, json_size,
                                             kJson};
  static_assert(sizeof head == kJsonBegin);
  if (Status status = file_->write(std::as_bytes(std::span(head))); !status) return status;
  if (Status status = file_->write(json_); !status) return status;
  if (size_ == 0) return {};
  const std::array<std::uint32_t, 2> data_head = {data_size, kBinary};
  return file_->write(std::as_bytes(std::span(data_head)));
}

// The buffer comes first, so that everything else can follow it.
Status Document::begin_text() {
  if (size_ == 0) return {};
  return file_->write(
      fmt::format("{{\n  \"buffers\": [\n    {{\n      \"byteLength\": {},\n      \"uri\": "
                  "\"data:application/octet-stream;base64,",
                  size_));
}

Status Document::append(std::span<const std::span<const std::byte>> parts) {
  if (options_.binary) return file_->write(parts);
  for (const auto part : parts) {
    if (Status status = append_encoded(part); !status) return status;
  }
  return {};
}

Status Document::append_encoded(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const auto here = bytes.first(std::min(bytes.size(), kEncodedAtOnce - unencoded_.size()));
    unencoded_.insert(unencoded_.end(), here.begin(), here.end());
    bytes = bytes.subspan(here.size());
    if (unencoded_.size() < kEncodedAtOnce) break;
    if (Status status = file_->write(to_base64(unencoded_)); !status) return status;
    unencoded_.clear();
  }
  return {};
}

Status Document::end(std::span<const Bounds> bounds) {
  const bool later = bounds_ > 0;
  assert(!later || bounds.size() == bounds_);
  if (later) fill_in(bounds);
  if (options_.binary) {
    return later ? file_->overwrite(kJsonBegin, std::as_bytes(std::span(json_))) : Status();
  }
  if (size_ == 0) return file_->write(json_);
  if (Status status = file_->write(to_base64(unencoded_)); !status) return status;
  if (Status status = file_->write("\"\n    }\n  ],\n"); !status) return status;
  return file_->write(std::string_view(json_).substr(2));  // without "{\n"
}

}  // namespace krok::gltf
