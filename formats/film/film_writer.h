#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/fed_program.h"
#include "core/file.h"
#include "core/result.h"

// Writes films with ffmpeg, which is looked up in PATH when it is needed.

namespace krok::film {

enum class Kind : unsigned char {
  mp4,   // H.264, 4:2:0, BT.709, with the index in front; width and height must be even
  gif,   // one palette for the whole film, repeats
  webp,  // animated, lossy, repeats
};

// By the extension of a path; empty for other extensions.
std::optional<Kind> kind_of(const std::string& path);

// Why no film can be written, with a hint; code film-ffmpeg.
Status check_encoder();

// Encodes frames in order. The bytes depend on the version of ffmpeg and on the frames alone; they
// contain no time.
class Writer {
 public:
  // Frames per second > 0, 1 <= width, height <= 16384. Codes: film-ffmpeg, film-size,
  // program-start.
  static Result<Writer> create(Kind kind, int width, int height, double rate);

  // [height x width x 3], sRGB. Code program-failed if ffmpeg fails.
  Status add(std::span<const std::uint8_t> rgb);

  // Writes the film to an empty file; the caller commits. Code program-failed.
  Status finish(OutputFile& file);

 private:
  explicit Writer(FedProgram program) : program_(std::move(program)) {}
  FedProgram program_;
};

}  // namespace krok::film
