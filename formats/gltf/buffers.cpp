#include "formats/gltf/buffers_internal.h"

#include <fmt/format.h>

#include "core/path_inside.h"

namespace krok::gltf {

namespace {

// For messages; data URIs can be megabytes long.
std::string shortened(const std::string& uri) {
  constexpr std::size_t kLongest = 60;
  return uri.size() > kLongest ? uri.substr(0, kLongest) + "..." : uri;
}

// Decodes percent-encoding (RFC 3986); nullopt if it is invalid or contains a zero byte.
std::optional<std::string> decode_percent(const std::string& text) {
  const auto digit = [](char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
  };
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '%') {
      const int high = i + 2 < text.size() ? digit(text[i + 1]) : -1;
      const int low = i + 2 < text.size() ? digit(text[i + 2]) : -1;
      if (high < 0 || low < 0) return std::nullopt;
      c = static_cast<char>(high * 16 + low);
      i += 2;
    }
    if (c == '\0') return std::nullopt;
    decoded += c;
  }
  return decoded;
}

// The file's path, if the URI is a relative path inside the folder, with links resolved.
Result<std::string> path_of_uri(const std::string& uri, const std::string& what,
                                const ReadOptions& options) {
  const auto refuse = [&](const char* why) {
    return Error("gltf-buffer", fmt::format("the {} '{}' {}", what, shortened(uri), why),
                 "external files must be inside the file's folder, or embedded (.glb)");
  };
  if (options.folder.empty() && !options.open) {
    return refuse("is an external file, but no folder is given");
  }
  const auto decoded = decode_percent(uri);
  if (!decoded) return refuse("is not a valid path");
  if (options.open) {
    const std::string fault = path_fault(*decoded);
    if (!fault.empty()) return refuse(fault.c_str());
    return *decoded;
  }
  auto path = path_inside(options.folder, *decoded);
  if (path) return path;
  return Error("gltf-buffer", fmt::format("the {}: {}", what, path.error().message),
               path.error().hint);
}

}  // namespace

bool is_data_uri(const std::string& uri) {
  return uri.starts_with("data:");
}

// Accepts any media type with base64 encoding.
Result<std::vector<unsigned char>> decode_data_uri(const std::string& uri,
                                                   const std::string& what) {
  constexpr std::string_view kMarker = ";base64,";
  const std::size_t marker = uri.find(kMarker);
  if (marker == std::string::npos || marker > 200) {
    return Error("gltf-buffer", fmt::format("{} is a data URI that is not base64", what));
  }
  // tinygltf uses int sizes, and supports few media types.
  if (uri.size() > 0x7FFFFFFFu) {
    return Error("gltf-too-large", fmt::format("{} is a data URI of {} bytes", what, uri.size()),
                 "save it as .glb");
  }
  std::vector<unsigned char> bytes;
  std::string media_type;
  tinygltf::DecodeDataURI(&bytes, media_type, "data:application/octet-stream" + uri.substr(marker),
                          0, false);
  return bytes;
}

Result<SideFile> open_beside(const std::string& uri, const std::string& what,
                             const ReadOptions& options, std::uint64_t most_bytes) {
  const auto path = path_of_uri(uri, what, options);
  if (!path) return path.error();
  SideFile result{*path, std::nullopt, {}};
  if (options.open) {
    auto unpacked = options.open(*path, most_bytes);
    if (!unpacked) return unpacked.error();
    result.unpacked = *std::move(unpacked);
    return result;
  }
  auto file = InputFile::open(*path, most_bytes);
  if (!file && file.error().code == "file-missing") {
    Error error = std::move(file).error();
    error.hint =
        fmt::format("the glTF file names it as its {}: copy it there, too, or export a .glb", what);
    return error;
  }
  if (!file) return file.error();
  result.file = *std::move(file);
  return result;
}

Result<Buffers> open_buffers(const std::vector<BufferEntry>& entries, const Container& container,
                             const ReadOptions& options) {
  Buffers buffers;
  std::uint64_t bytes_left = options.most_bytes;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const BufferEntry& entry = entries[i];
    std::span<const std::byte> bytes;
    if (entry.fallback && !entry.has_uri) {
      buffers.views.emplace_back();
      continue;
    }
    if (!entry.has_uri) {
      if (!container.binary || i != 0) {
        return Error("gltf-buffer", fmt::format("buffer {} has no data: no URI, and not the GLB's "
                                                "binary chunk (buffer 0)",
                                                i));
      }
      bytes = container.bin;
    } else if (is_data_uri(entry.uri)) {
      auto decoded = decode_data_uri(entry.uri, fmt::format("buffer {}", i));
      if (!decoded) return decoded.error();
      buffers.decoded.push_back(std::move(*decoded));
      bytes = std::as_bytes(std::span(buffers.decoded.back()));
    } else {
      auto file = open_beside(entry.uri, "buffer", options, bytes_left);
      if (!file) return file.error();
      buffers.files.push_back(std::move(*file));
      bytes = buffers.files.back().bytes();
    }
    if (entry.byte_length > bytes.size()) {
      return Error("gltf-buffer",
                   fmt::format("buffer {} should have {} bytes but has {}", i, entry.byte_length,
                               bytes.size()),
                   "the file is damaged or truncated");
    }
    if (bytes.size() > bytes_left) {
      return Error("gltf-too-large",
                   fmt::format("the buffers exceed the limit of {} bytes", options.most_bytes));
    }
    bytes_left -= bytes.size();
    buffers.views.push_back(bytes.first(entry.byte_length));
  }
  return buffers;
}

}  // namespace krok::gltf
