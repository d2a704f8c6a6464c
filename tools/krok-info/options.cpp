#include "tools/krok-info/options.h"

#include <memory>

#include "formats/io/formats.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::info {

namespace {

void declare(CommandOptions& command, Options& options) {
  command.add_option("FILE", options.files, "Files of these kinds; - is standard input")
      .type_name("")
      .required();
  add_map_option(command, options.map);
  command.add_flag("--textconv", options.textconv,
                   "Print a motion as lines that git diff compares (krok git-setup): ranges and "
                   "checksums for each second and joint, at most 2,000 lines; a file that cannot "
                   "be read is one line and no error");
}

}  // namespace

ToolSpec make_spec() {
  const auto options = std::make_shared<Options>();
  ToolSpec spec = spec_of<Options>("krok-info", options, declare, nullptr, run);
  spec.summary = "Prints the contents of files";
  spec.details =
      "Motions (.anim), models (.model), cameras (.cam), step libraries (.steps), materials "
      "(.material), characters (.character; glTF, FBX, COLLADA, SMD, MS3D, 3DS, ASE, MD5), "
      "morph targets (.exr), labels over time (.TextGrid), captures (.bvh, .asf, .amc). More than "
      "four files are shown as a table, with -v each in full.";
  spec.inputs = "FILE...";
  spec.folder_endings = io::endings([](const io::Format& format) { return !format.companion; });
  spec.examples = {
      {"krok-info walk.anim", "frames, rate, duration, size, provenance and joint roles"},
      {"krok-info -v capture.bvh", "also each joint with its role, and the reader's notes"},
      {"krok-info captures/", "a table of all files in a folder, their kinds, rates and duration"},
      {"krok-info --json *.model > models.json", "the same as JSON for scripts"}};
  spec.has_output = false;
  return spec;
}

}  // namespace krok::cli::info
