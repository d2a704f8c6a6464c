#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/gltf/json_text_internal.h"
#include "scene/encoded_image.h"

// Private to this folder: loads images from buffers, data URIs and external files.

namespace krok::gltf {

// Nothing in the file is trusted. Memory is proportional to the input: all images from buffers
// together take at most the size of the buffers.
class Images {
 public:
  Images(const ParsedJson& parsed, std::span<const std::span<const std::byte>> buffers,
         const ReadOptions& options);

  // The image with this index, loaded once; null if it is unusable, with a warning (code
  // gltf-picture) on the first call.
  std::shared_ptr<const EncodedImage> get(std::size_t image, Diagnostics& diagnostics);

  // Paths of the external files that were read.
  const std::vector<std::string>& files() const { return files_; }

 private:
  Result<std::shared_ptr<const EncodedImage>> read(std::size_t image);
  Result<std::vector<std::byte>> bytes_of_view(const nlohmann::json& number);
  Result<std::shared_ptr<const EncodedImage>> beside(const std::string& uri,
                                                     const std::string& name);

  const ParsedJson& parsed_;
  std::span<const std::span<const std::byte>> buffers_;
  const ReadOptions& options_;
  std::uint64_t in_buffers_left_ = 0, beside_left_ = 0;               // bytes
  std::map<std::size_t, std::shared_ptr<const EncodedImage>> known_;  // by index
  std::map<std::string, std::shared_ptr<const EncodedImage>> by_file_;
  std::vector<std::string> files_;
};

}  // namespace krok::gltf
