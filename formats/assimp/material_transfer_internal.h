#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "core/bytes.h"
#include "formats/assimp/parser_internal.h"
#include "scene/material.h"

// Private to this folder: transfers materials from the child process.

namespace krok::assimp {

inline void put_text(ByteWriter& out, std::string_view text) {
  out.write(static_cast<std::uint64_t>(text.size()));
  out.append_text(text);
}

template <typename T>
void put_array(ByteWriter& out, const std::vector<T>& values) {
  out.write(static_cast<std::uint64_t>(values.size()));
  out.append(std::as_bytes(std::span(values)));
}

// Shared images are written once: `number_of` has those already written.
void put_material(ByteWriter& out, const Material& material,
                  std::map<const EncodedImage*, std::int32_t>& number_of);

// `images` has those already read.
Material take_material(Parser& in, std::vector<std::shared_ptr<const EncodedImage>>& images);

}  // namespace krok::assimp
