#include <fmt/format.h>

#include "core/text.h"
#include "formats/io/formats.h"
#include "formats/io/readers_internal.h"
#include "formats/npy/array_reader.h"

namespace krok::io {

namespace {

// What --skeleton names: a published order, a list of columns, a model of SMPL, a motion.
Status take_skeleton(const std::string& name, Inputs& inputs, npy::ReadOptions& options,
                     std::shared_ptr<const InputFile>& body) {
  options.columns_name = name;
  options.columns = named_skeleton(name);
  if (options.columns) return {};
  if (extension(name).empty()) {
    const std::vector<std::string> names = skeleton_names();
    const std::string nearest = nearest_name(name, names);
    return Error("npy-skeleton", fmt::format("there is no skeleton {}", shown(name)),
                 nearest.empty() ? fmt::format("known are {}", fmt::join(names, ", "))
                                 : fmt::format("did you mean {}? known are {}", nearest,
                                               fmt::join(names, ", ")));
  }
  auto opened = inputs.open_input(name);
  if (!opened) return opened.error();
  body = std::make_shared<const InputFile>(*std::move(opened));
  if (npy::is_smpl_body(body->bytes())) {
    options.body = body->bytes();
    return {};
  }
  if (without_byte_order_mark(trimmed(body->text().substr(0, 64))).starts_with('{')) {
    auto columns = npy::read_columns(body->text());
    if (!columns) return std::move(columns.error()).in_file(name);
    options.columns = *std::move(columns);
    return {};
  }
  PlainInputs quiet;  // the skeleton alone is of interest
  auto clip = open_motion(*body, quiet);
  if (!clip) return std::move(clip.error()).in_file(name);
  options.skeleton = std::move(clip->skeleton);
  return {};
}

}  // namespace

Result<OpenedCapture> open_arrays(const InputFile& file, Inputs& inputs,
                                  const CaptureReading& reading, bool stream) {
  if (Status status = check_bvh_choices(reading); !status) return status.error();
  if (reading.rest_frame != RestFrame::keep) {
    return Error("usage", "--skip-rest-frame is for BVH and AMC");
  }
  npy::ReadOptions options;
  static_cast<CaptureOptions&>(options) = reading;
  options.motion = reading.motion;
  std::shared_ptr<const InputFile> skeleton;
  if (!reading.skeleton.empty()) {
    Status status = take_skeleton(reading.skeleton, inputs, options, skeleton);
    if (!status) return status.error();
  }
  constexpr std::size_t kLongTransforms = std::size_t{1} << 19;
  if (stream) {
    if (auto found = npy::open(file.bytes(), file.path(), options, kLongTransforms)) {
      OpenedCapture opened;
      opened.streamed = true;
      opened.details.motions = static_cast<int>(found->motions);
      auto capture = std::make_shared<npy::OpenedCapture>(*std::move(found));
      opened.frames = capture->frames;
      opened.capture = std::move(capture);
      return opened;
    }
  }
  auto read = npy::read(file.bytes(), file.path(), options);
  if (!read) return std::move(read).error();
  CaptureDetails details;
  details.motions = static_cast<int>(read->motions);
  auto capture = std::make_shared<npy::Capture>(*std::move(read));
  OpenedCapture opened;
  opened.frames = frames_of(capture->clip);
  opened.capture = std::move(capture);
  opened.details = std::move(details);
  return opened;
}

}  // namespace krok::io
