#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/hash.h"
#include "core/index.h"
#include "core/numbers.h"
#include "core/result.h"
#include "core/text.h"
#include "formats/io/formats.h"
#include "formats/io/open_motion.h"
#include "formats/io/open_scene.h"
#include "formats/registry/registry.h"
#include "math/quaternion.h"
#include "tools/cli/tool.h"
#include "tools/krok-info/describe.h"
#include "tools/krok-info/description.h"
#include "tools/krok-info/options.h"
#include "tools/shared/shared_options.h"

namespace krok::cli::info {

namespace {

constexpr int kMaxLines = 1990;                         // besides those of the header
constexpr double kPlaces = 2e4;                         // a metre, to 0.05 mm
constexpr double kTurns = 1 / kRadiansPerDegree * 1e2;  // about radians, to 0.01 degrees
constexpr std::string_view kPointer = "version https://git-lfs.github.com/spec/";

// What a joint does in a stretch of time.
struct Part {
  Vec3 low = Vec3::Constant(INFINITY), high = Vec3::Constant(-INFINITY);  // of quaternions
  Vec3 low_place = low, high_place = high;
  int frames = 0;
  // Sums of the values of all frames, each by a weight of its own, of which the checksum is made: a
  // change of one value changes its sum, and rounding errors, which cancel out, change none.
  double turns = 0, places = 0;
};

std::int64_t rounded(double value, double scale) {
  return std::llrint(std::clamp(value * scale, -4e18, 4e18));
}

// Of the terms of a sum, 0.5 to 1 or -0.5 to -1.
double weight(int term) {
  const std::uint32_t mixed = (static_cast<std::uint32_t>(term) + 1) * 0x9e3779b9U;
  const double size = 0.5 + (mixed >> 9U & 0xffffU) / 131072.0;
  return (mixed & 0x80000000U) != 0 ? -size : size;
}

// `turn` is a unit quaternion, x, y, z, w.
void add(const Vec4& turn, const Vec3* place, Part& part) {
  part.low = part.low.cwiseMin(turn.head<3>()), part.high = part.high.cwiseMax(turn.head<3>());
  // Products, which do not change with the quaternion's sign.
  const double x = turn.x(), y = turn.y(), z = turn.z(), w = turn.w(), u = 2 * weight(part.frames);
  part.turns += u * (w * (x + 0.8 * y - 0.7 * z) + 0.9 * x * y + 0.6 * y * z - 0.5 * z * x +
                     0.4 * x * x - 0.3 * y * y);
  if (place != nullptr) {
    part.low_place = part.low_place.cwiseMin(*place);
    part.high_place = part.high_place.cwiseMax(*place);
    part.places += u / 2 * (place->x() + 0.8 * place->y() - 0.7 * place->z());
  }
  ++part.frames;
}

// Degrees, of the component of a quaternion: about one axis alone, the angle.
Vec3 angles_of(const Vec3& components) {
  return 2 / kRadiansPerDegree * components.cwiseMax(-1).cwiseMin(1).array().asin();
}

std::string range(const Vec3& low, const Vec3& high, double scale) {
  std::string text;
  for (int axis = 0; axis < 3; ++axis) {
    text += fmt::format(" {:.1f}..{:.1f}", scale * low[axis] + 0.0, scale * high[axis] + 0.0);
  }
  return text;
}

class Text {
 public:
  explicit Text(const FrameSource& frames) : frames_(frames) {
    const double seconds = std::max(frames.duration(), 1 / frames.rate);
    shown_ = std::min(frames.joint_count(), kMaxLines);
    const double stretches = std::max(1, kMaxLines / std::max(1, shown_));
    stretch_ =
        std::max(1, static_cast<int>(std::ceil(std::ceil(seconds / stretches) * frames.rate)));
  }

  Result<std::string> made() {
    header();
    const int joints = frames_.joint_count();
    std::vector<Vec3f> places;
    std::vector<Quatf> turns;
    constexpr int kAtOnce = 256;
    std::vector<Part> parts(at(joints));
    for (int first = 0; first < frames_.frame_count; first += kAtOnce) {
      const int count = std::min(kAtOnce, frames_.frame_count - first);
      places.resize(at(count) * at(joints));
      turns.resize(places.size());
      if (Status status = frames_.read(first, count, places, turns); !status) return status.error();
      for (int f = 0; f < count; ++f) {
        const auto row = at(f) * at(joints);
        add_frame(std::span(places).subspan(row, at(joints)),
                  std::span(turns).subspan(row, at(joints)), parts);
        if ((first + f + 1) % stretch_ == 0 || first + f + 1 == frames_.frame_count) {
          finish((first + f) / stretch_ * stretch_, parts);
        }
      }
      if (frames_.release) frames_.release(first + count);
    }
    return text_;
  }

 private:
  void header() {
    const Skeleton& skeleton = frames_.skeleton;
    std::vector<std::int64_t> reference;
    std::string names;
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      const Transform local = skeleton.reference_local(j);
      names += fmt::format("{}<{};", skeleton.names[at(j)], skeleton.parents[at(j)]);
      for (int axis = 0; axis < 3; ++axis) {
        reference.push_back(rounded(local.position[axis], kPlaces));
      }
    }
    text_ = fmt::format("motion: {} joints, {} frames at {} fps\n", skeleton.joint_count(),
                        frames_.frame_count, readable(frames_.rate));
    text_ += fmt::format("skeleton: #{}, bones #{}\n",
                         hex(xxh3(std::as_bytes(std::span(names)))).substr(0, 8),
                         hex(xxh3(std::as_bytes(std::span(reference)))).substr(0, 8));
    if (shown_ < skeleton.joint_count()) {
      text_ += fmt::format("the first {} joints:\n", shown_);
    }
  }

  void add_frame(std::span<const Vec3f> places, std::span<const Quatf> turns,
                 std::vector<Part>& parts) const {
    for (int j = 0; j < shown_; ++j) {
      const int parent = frames_.skeleton.parents[at(j)];
      if (frames_.skeleton.end_sites[at(j)] != 0) continue;
      const Quat own = turns[at(j)].cast<double>();
      const Quat local = parent < 0 ? own : turns[at(parent)].cast<double>().conjugate() * own;
      const double length = local.norm();
      const Vec4 turn = local.coeffs() / (local.w() < 0 ? -length : length);
      const Vec3 place = places[at(j)].cast<double>();
      add(turn, parent < 0 ? &place : nullptr, parts[at(j)]);
    }
  }

  void finish(int first, std::vector<Part>& parts) {
    for (int j = 0; j < shown_; ++j) {
      Part& part = parts[at(j)];
      if (part.frames == 0) continue;
      const std::array sums = {rounded(part.turns, kTurns), rounded(part.places, kPlaces)};
      text_ += fmt::format("{:.2f} s {}: deg{}", first / frames_.rate,
                           printable(frames_.skeleton.names[at(j)]),
                           range(angles_of(part.low), angles_of(part.high), 1));
      if (std::isfinite(part.low_place.x())) {
        text_ += " mm" + range(part.low_place, part.high_place, 1000);
      }
      text_ += fmt::format(" #{}\n", hex(xxh3(std::as_bytes(std::span(sums)))).substr(0, 8));
      part = {};
    }
  }

  const FrameSource& frames_;
  int shown_ = 0, stretch_ = 1;
  std::string text_;
};

// A motion as text for `git diff`, at most 2,000 lines: for each stretch of time (a second, or more
// of long motions) and each joint the range of its rotation in its parent about x, y and z (by the
// components of its quaternion, degrees) and a checksum of its values to 0.01 degrees, of the root
// also its place (mm, to 0.05 mm). A change of one joint in one frame changes one line; how a file
// writes its numbers changes none. A Git LFS pointer and a file that cannot be read are one line.
//
// Empty for a file that holds no motion.
std::optional<std::string> textconv(const InputFile& file) {
  const std::string_view text = file.text();
  if (text.starts_with(kPointer)) {
    std::string line = "Git LFS pointer:";
    for (const std::string_view key : {"\noid ", "\nsize "}) {
      const auto begin = text.find(key);
      if (begin == std::string_view::npos) continue;
      const auto end = text.find('\n', begin + 1);
      line += ' ' + printable(text.substr(begin + 1, end - begin - 1));
    }
    return line.substr(0, 200) + '\n';
  }
  if (!io::format_of(file).reads_motion()) return std::nullopt;
  io::PlainInputs inputs;
  std::string made;
  const auto summary =
      io::stream_motion(file.path(), inputs, [&](const FrameSource& frames) -> Status {
        auto result = Text(frames).made();
        if (!result) return result.error();
        made = *std::move(result);
        return {};
      });
  if (!summary) {
    return fmt::format("cannot be read: {} [{}]\n", printable(summary.error().message),
                       summary.error().code);
  }
  return made;
}

Result<Description> describe(const InputFile& file, const SkeletonOptions& how,
                             ToolContext& context) {
  using registry::Kind;
  const Kind kind = registry::identify(file.path(), file.bytes());
  if (io::is_scene(kind)) return describe_scene(file, kind, how, context);
  constexpr std::pair<Kind, Describe*> kDescribers[] = {
      {Kind::anim, describe_anim},         {Kind::model, describe_model},
      {Kind::cam, describe_cam},           {Kind::steps, describe_steps},
      {Kind::material, describe_material}, {Kind::character, describe_character},
      {Kind::ragdoll, describe_ragdoll},   {Kind::correctives, describe_correctives},
      {Kind::bvh, describe_bvh},           {Kind::asf, describe_acclaim},
      {Kind::amc, describe_acclaim}};
  for (const auto& [described, describe_it] : kDescribers) {
    if (kind == described) return describe_it(file, how, context);
  }
  if (io::is_motion(file)) return describe_motion(file, how, context);
  const std::string ending = extension(file.path());
  if (ending == ".exr") return describe_morphs(file, how, context);
  if (ending == ".textgrid") return describe_textgrid(file, how, context);
  return Error(
      "info-kind",
      "is " + std::string(registry::describe_content(file.bytes())) +
          ", which krok-info cannot read",
      "supported are .anim, .model, .cam, .steps, .material, .character, .ragdoll.json, "
      ".correctives, .exr, .TextGrid, .bvh, .asf, .amc, .glb and .gltf files, and characters in "
      ".fbx, .dae, .smd, .ms3d, .3ds, .ase, .md5mesh and .md5anim files");
}

Result<Description> describe_path(const std::string& path, const SkeletonOptions& how,
                                  ToolContext& context) {
  const auto file = context.open_input(path);
  if (!file) return file.error();
  auto description = describe(*file, how, context);
  if (!description) return std::move(description).error().in_file(path);
  description->json["bytes"] = file->bytes().size();
  return description;
}

// A line for what is no motion or cannot be read: git stops at a text conversion that fails.
Result<int> print_for_git(const Options& options, ToolContext& context) {
  for (const std::string& path : options.files) {
    const auto file = InputFile::open(path);
    const auto text = file ? textconv(*file) : std::optional<std::string>("cannot be opened\n");
    context.print(text ? *text
                       : fmt::format("{}, {} bytes, #{}\n",
                                     registry::describe_content(file->bytes()),
                                     file->bytes().size(), hex(xxh3(file->bytes()))));
  }
  return kExitDone;
}

}  // namespace

Result<int> run(const Options& options, ToolContext& context) {
  if (options.textconv) return print_for_git(options, context);
  auto roles = io::open_role_map(options.map, context);
  if (!roles) return roles.error();
  const SkeletonOptions how{*std::move(roles), !options.map.empty(), context.verbose};
  Json files = Json::array();
  bool failed = false;
  bool first = true;
  // More are shown as a table.
  constexpr std::size_t kInFull = 4;
  const bool in_full = context.verbose || options.files.size() <= kInFull;
  for (const std::string& path : options.files) {
    auto description = describe_path(path, how, context);
    Json entry = {{"path", path}};
    if (description) {
      entry.update(description->json);
      if (in_full && !context.quiet) {
        context.print((first ? "" : "\n") + to_text(path, *description));
      }
      first = false;
    } else {
      failed = true;
      entry["error"] = description.error().code;
      context.diagnose(std::move(description).error());
    }
    files.push_back(std::move(entry));
  }
  if (!in_full && !context.quiet) context.print(folder_summary(files));
  context.report.result["files"] = std::move(files);
  return failed ? kExitTrouble : kExitDone;
}

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
