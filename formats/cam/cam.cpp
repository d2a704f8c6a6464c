#include "formats/cam/cam.h"

#include <fmt/format.h>

#include <cstring>
#include <limits>

#include "formats/container/sections.h"

namespace krok::cam {

namespace {

constexpr ContainerFormat kFormat = {registry::Kind::cam, registry::kCamMagic, 1,
                                     kFlagFourComponents};

struct Info {
  double rate;
  std::uint64_t frame_count;
};
static_assert(sizeof(Info) == 16);

// A frame: position, orientation, field of view.
constexpr std::size_t frame_size(OrientationEncoding encoding) {
  return transform_size(encoding) + sizeof(float);
}

}  // namespace

Status write(const CameraTrack& camera, const WriteOptions& options, OutputFile& file) {
  if (Status status = check(camera); !status) return status;
  const Info info = {camera.rate, camera.positions.size()};
  const std::size_t size = frame_size(options.orientation);
  std::vector<std::byte> frames(camera.positions.size() * size);
  for (std::size_t i = 0; i < camera.positions.size(); ++i) {
    std::byte* frame = &frames[i * size];
    write_transform(camera.positions[i], camera.orientations[i].cast<double>(), options.orientation,
                    frame);
    std::memcpy(frame + size - sizeof(float), &camera.fields_of_view[i], sizeof(float));
  }
  const std::vector<std::uint32_t> cuts(camera.cuts.begin(), camera.cuts.end());
  ContainerWriter container(file, kFormat, orientation_flags(options.orientation),
                            cuts.empty() ? 3 : 4);
  Status status = container.section("INFO", std::as_bytes(std::span(&info, 1)));
  if (status) status = container.section("FRAMES", frames);
  if (status && !cuts.empty()) status = container.section("CUTS", std::as_bytes(std::span(cuts)));
  if (status) status = write_provenance(camera.provenance, container);
  if (status) status = container.finish();
  return status;
}

Result<CameraTrack> read(std::span<const std::byte> file) {
  const auto container = ContainerReader::open(file, kFormat);
  if (!container) return container.error();
  const auto info_section = container->section("INFO", 1, sizeof(Info));
  if (!info_section) return info_section.error();
  const auto info = ByteReader(info_section->bytes).read<Info>();
  if (info.frame_count > static_cast<std::uint64_t>(std::numeric_limits<int>::max())) {
    return at_section(Error("camera-shape",
                            fmt::format("has {} frames, expected up to {}", info.frame_count,
                                        std::numeric_limits<int>::max()),
                            "create the file again"),
                      *container, "INFO");
  }
  const OrientationEncoding encoding = orientation_encoding(*container);
  const std::size_t size = frame_size(encoding);
  const auto frames = container->section("FRAMES", info.frame_count, size);
  if (!frames) return frames.error();
  auto provenance = read_provenance(*container);
  if (!provenance) return provenance.error();

  CameraTrack camera;
  camera.rate = info.rate;
  camera.provenance = *std::move(provenance);
  camera.positions.resize(info.frame_count);
  camera.orientations.resize(info.frame_count);
  camera.fields_of_view.resize(info.frame_count);
  for (std::size_t i = 0; i < info.frame_count; ++i) {
    const std::byte* frame = &frames->bytes[i * size];
    Quat orientation;
    read_transform(frame, encoding, camera.positions[i], orientation);
    camera.orientations[i] = orientation.cast<float>();
    std::memcpy(&camera.fields_of_view[i], frame + size - sizeof(float), sizeof(float));
  }
  if (const auto found = container->find("CUTS"); found) {
    const std::size_t count = found->bytes.size() / sizeof(std::uint32_t);
    const auto cuts = container->section("CUTS", count, sizeof(std::uint32_t));
    if (!cuts) return cuts.error();
    ByteReader reader(cuts->bytes);
    // Numbers that are no frames fail in check().
    for (std::size_t i = 0; i < count; ++i) {
      camera.cuts.push_back(static_cast<int>(reader.read<std::uint32_t>()));
    }
  }
  if (Status status = check(camera); !status) {
    const std::string& code = status.error().code;
    const char* section = code == "camera-rate" ? "INFO" : code == "camera-cut" ? "CUTS" : "FRAMES";
    return at_section(std::move(status).error(), *container, section);
  }
  return camera;
}

}  // namespace krok::cam
