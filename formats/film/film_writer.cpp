#include "formats/film/film_writer.h"

#include <fmt/format.h>

#include <vector>

#include "core/numbers.h"

namespace krok::film {

namespace {

constexpr int kMaxSize = 16384;

Error no_encoder() {
  return Error("film-ffmpeg", "films are encoded by ffmpeg, which is not installed",
               "apt-get install ffmpeg; or write frames, which need none: -o 'frame_%04d.png'");
}

std::vector<std::string> encoder_of(Kind kind) {
  switch (kind) {
    case Kind::mp4:
      return {"-vf",
              ("scale=in_range=full:out_range=limited:out_color_matrix=bt709:flags=accurate_rnd+"
               "full_chroma_int,format=yuv420p"),
              "-c:v",
              "libx264",
              "-preset",
              "medium",
              "-crf",
              "18",
              "-colorspace",
              "bt709",
              "-color_primaries",
              "bt709",
              "-color_trc",
              "bt709",
              "-color_range",
              "tv",
              "-movflags",
              "+faststart",
              "-f",
              "mp4"};
    case Kind::gif:
      return {"-filter_complex",
              ("split[a][b];[a]palettegen=stats_mode=diff[p];[b][p]paletteuse=dither=bayer:"
               "bayer_scale=4:diff_mode=rectangle"),
              "-loop",
              "0",
              "-f",
              "gif"};
    case Kind::webp:
      return {"-c:v", "libwebp_anim", "-lossless", "0",  "-quality",
              "80",   "-loop",        "0",         "-f", "webp"};
  }
  return {};
}

}  // namespace

std::optional<Kind> kind_of(const std::string& path) {
  const std::string ending = extension(path);
  if (ending == ".mp4") return Kind::mp4;
  if (ending == ".gif") return Kind::gif;
  if (ending == ".webp") return Kind::webp;
  return std::nullopt;
}

Status check_encoder() {
  if (find_program("ffmpeg")) return {};
  return no_encoder();
}

Result<Writer> Writer::create(Kind kind, int width, int height, double rate) {
  const auto path = find_program("ffmpeg");
  if (!path) return no_encoder();
  if (width < 1 || height < 1 || width > kMaxSize || height > kMaxSize) {
    return Error("film-size", fmt::format("{} x {} pixels are out of range", width, height));
  }
  if (kind == Kind::mp4 && (width % 2 != 0 || height % 2 != 0)) {
    return Error("film-size", fmt::format("{} x {} pixels: an mp4 needs an even width and height",
                                          width, height));
  }
  // One thread: the number of threads changes the bytes.
  std::vector<std::string> words = {"-hide_banner",
                                    "-nostdin",
                                    "-loglevel",
                                    "error",
                                    "-y",
                                    "-filter_threads",
                                    "1",
                                    "-filter_complex_threads",
                                    "1",
                                    "-f",
                                    "rawvideo",
                                    "-pix_fmt",
                                    "rgb24",
                                    "-video_size",
                                    fmt::format("{}x{}", width, height),
                                    "-framerate",
                                    shortest(rate),
                                    "-i",
                                    "pipe:0",
                                    "-map_metadata",
                                    "-1",
                                    "-threads",
                                    "1",
                                    "-fflags",
                                    "+bitexact",
                                    "-flags:v",
                                    "+bitexact"};
  for (const std::string& word : encoder_of(kind)) words.push_back(word);
  words.emplace_back(FedProgram::kResult);
  auto program = FedProgram::start(*path, words);
  if (!program) return program.error();
  return Writer(*std::move(program));
}

Status Writer::add(std::span<const std::uint8_t> rgb) {
  return program_.feed(std::as_bytes(rgb));
}

Status Writer::finish(OutputFile& file) {
  const auto bytes = program_.finish();
  if (!bytes) return bytes.error();
  return file.write(*bytes);
}

}  // namespace krok::film
