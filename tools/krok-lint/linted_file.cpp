#include "tools/krok-lint/linted_file.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/index.h"
#include "core/numbers.h"
#include "core/parallel.h"
#include "core/text.h"
#include "formats/io/open_motion.h"
#include "motion/ground_frame.h"
#include "motion/travel.h"
#include "tools/cli/file_name.h"

namespace krok::cli::lint {

namespace {

using krok::lint::Finding;

// Files that are open at once.
constexpr std::size_t kOpenFiles = 64;

bool is_named_loop(const std::string& path) {
  const std::string name = ascii_lower(name_of_input(path));
  return name.find("loop") != std::string::npos || name.find("cycle") != std::string::npos;
}

// The height of the ground below a point, or of what is just above it.
std::optional<double> height_below(const Terrain& ground, const Vec3& point) {
  constexpr double kAbove = 0.3;  // metres that a foot may be below the surface
  const auto found = ground.at(point.x(), point.z(), point.y() + kAbove);
  if (!found) return std::nullopt;
  return found->height;
}

void lint_file(const InputFile& input, const Options& options, const io::FindRoles& find_roles,
               const krok::lint::MotionOptions& how, LintedFile& file) {
  io::PlainInputs inputs;
  inputs.jobs = 1;
  const auto clip = io::open_motion(input, inputs);
  file.diagnostics = std::move(inputs.diagnostics);
  if (!clip) {
    file.error = clip.error();
    return;
  }
  file.joints = clip->skeleton.names;
  file.rate = clip->rate, file.frames = clip->frame_count();
  const auto roles = find_roles(clip->skeleton);
  if (!roles) {
    file.error = roles.error();
    return;
  }
  auto faults = faults_of(*clip, *roles, file.path, options, how);
  file.findings = std::move(faults.findings);
  file.notes = std::move(faults.notes);
  if (how.settings.has(krok::lint::Rule::duplicate)) {
    file.signature = krok::lint::signature_of(*clip, *roles);
  }
}

void add_duplicates(const krok::lint::Settings& settings, std::vector<LintedFile>& files) {
  using krok::lint::Rule;
  std::vector<krok::lint::Signature> signatures;
  for (const LintedFile& file : files) signatures.push_back(file.signature);
  const double degrees = settings.threshold(Rule::duplicate);
  for (const auto& [first, second] :
       krok::lint::find_duplicates(signatures, degrees * kRadiansPerDegree)) {
    LintedFile& file = files[at(second)];
    if (file.path == files[at(first)].path) continue;
    Finding finding;
    finding.rule = Rule::duplicate;
    finding.last = std::max(0, file.frames - 1);
    finding.value = 1;
    finding.detail = "the same motion as " + to_utf8(files[at(first)].path);
    file.findings.push_back(std::move(finding));
  }
}

}  // namespace

std::string LintedFile::joint_of(const Finding& finding) const {
  return finding.joint < 0 ? "" : joints[at(finding.joint)];
}

std::string quantity_text(double value, const std::string& unit) {
  if (unit == "m" && std::abs(value) < 1) return readable(1000 * value, 3) + " mm";
  if (unit.empty()) return readable(value, 3);
  return readable(value, 3) + " " + unit;
}

std::string text_of(const Finding& finding, const LintedFile& file) {
  std::string text = finding.joint < 0 ? "body" : printable(file.joint_of(finding));
  if (finding.joints > 1) {
    text += fmt::format(" and {} more", finding.joints - 1);
  }
  if (!finding.kind.empty()) text += ", " + finding.kind;
  const bool measured = finding.threshold > 0;  // else the detail says all
  if (!measured) return text + ": " + printable(finding.detail);
  text += ": " + quantity_text(finding.value, finding.unit);
  text += ", limit " + quantity_text(finding.threshold, finding.unit);
  if (finding.last > finding.first + 1 && finding.last - finding.first + 1 < file.frames) {
    text += fmt::format(", {:.2f} to {:.2f} s", file.seconds(finding.first),
                        file.seconds(finding.last));
  }
  if (!finding.detail.empty()) text += " (" + printable(finding.detail) + ")";
  return text;
}

krok::lint::MotionOptions judging(const Options& options, const krok::lint::Settings& settings,
                                  const Terrain* ground) {
  krok::lint::MotionOptions how;
  how.settings = settings;
  how.treadmill = options.treadmill;
  if (ground != nullptr) {
    how.ground = [ground](const Vec3& point) { return height_below(*ground, point); };
  }
  return how;
}

krok::lint::MotionFaults faults_of(const Clip& clip, const RoleMap& roles, const std::string& path,
                                   const Options& options, const krok::lint::MotionOptions& how) {
  krok::lint::MotionOptions mine = how;
  mine.is_loop = options.loops || is_named_loop(path);
  // Feet of a motion in place slide as fast as it would travel.
  const auto moving = travelling(clip, carrying_joint(roles));
  return krok::lint::lint_motion(moving ? *moving : clip, roles, mine);
}

std::vector<LintedFile> lint_all(const Options& options, const krok::lint::MotionOptions& how,
                                 const io::FindRoles& find_roles, ToolContext& context) {
  // Each motion takes the memory of the one before: the system is slow to take it back and give it
  // again, page by page.
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
  mallopt(M_TOP_PAD, 16 << 20);
  std::vector<LintedFile> files(options.inputs.size());
  context.progress->begin("looking for faults", files.size());
  for (std::size_t begin = 0; begin < files.size(); begin += kOpenFiles) {
    const std::size_t count = std::min(kOpenFiles, files.size() - begin);
    std::vector<std::optional<InputFile>> inputs(count);
    for (std::size_t i = 0; i < count; ++i) {
      LintedFile& file = files[begin + i];
      file.path = options.inputs[begin + i];
      auto input = context.open_input(file.path);
      if (input) {
        inputs[i] = *std::move(input);
      } else {
        file.error = input.error();
      }
    }
    parallel_for(count, 1, context.jobs, [&](std::size_t first, std::size_t end) {
      for (std::size_t i = first; i < end; ++i) {
        if (inputs[i]) lint_file(*inputs[i], options, find_roles, how, files[begin + i]);
        inputs[i].reset();
        context.progress->advance(1);
      }
    });
  }
  context.progress->end();
  if (how.settings.has(krok::lint::Rule::duplicate)) add_duplicates(how.settings, files);
  for (LintedFile& file : files) {
    std::ranges::stable_sort(file.findings, [](const Finding& a, const Finding& b) {
      const auto key = [](const Finding& f) {
        return std::tuple(-static_cast<int>(krok::lint::facts_of(f.rule).severity), -f.excess());
      };
      return key(a) < key(b);
    });
  }
  return files;
}

}  // namespace krok::cli::lint
