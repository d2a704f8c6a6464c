#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "core/json_internal.h"
#include "core/text.h"
#include "formats/container/sections.h"
#include "formats/steps/records_internal.h"
#include "formats/steps/steps.h"

namespace krok::steps {

namespace {

using namespace detail;
using parametric::Example;
using parametric::Library;
using parametric::Parameter;

Vec3 vector(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

Error invalid(const ContainerReader& container, std::string_view section, std::string message) {
  return at_section(Error("steps-shape", std::move(message), "create the file again"), container,
                    section);
}

Result<Info> read_info(const ContainerReader& container) {
  const auto section = container.section("INFO", 1, sizeof(Info));
  if (!section) return section.error();
  const auto info = ByteReader(section->bytes).read<Info>();
  if (info.joints >= 1 && info.joints <= kMaxFileJoints && info.keytimes >= 2 &&
      info.keytimes <= kMaxKeytimes && info.parameters >= 1 && info.parameters <= kMaxParameters &&
      info.examples >= 1 && info.examples <= kMaxExamples && info.swing <= 1 &&
      std::isfinite(info.ground)) {
    return info;
  }
  return invalid(
      container, "INFO",
      fmt::format("has invalid values: {} joints, {} keytimes, {} parameters, {} examples and "
                  "swing foot {}",
                  info.joints, info.keytimes, info.parameters, info.examples, info.swing));
}

// The roles given to joints, if there are any: [joints] texts, empty for the others.
Status read_roles(const ContainerReader& container, Library& library) {
  if (!container.find("ROLES")) return {};
  const auto labels = read_texts(container, "ROLES", library.skeleton.names.size());
  if (!labels) return labels.error();
  for (std::size_t j = 0; j < labels->size(); ++j) {
    const std::string& label = (*labels)[j];
    if (label.empty()) continue;
    auto given = parse_role_label(label);
    if (!given) return invalid(container, "ROLES", fmt::format("has no role {}", shown(label)));
    given->joint = static_cast<int>(j);
    library.given_roles.push_back(*given);
  }
  return {};
}

Status read_frame(const ContainerReader& container, const Info& info, Library& library) {
  auto skeleton = read_skeleton(container, info.joints);
  if (!skeleton) return skeleton.error();
  library.skeleton = *std::move(skeleton);
  library.rate = info.rate;
  library.ground = static_cast<double>(info.ground);
  library.swing = info.swing == 0 ? FootSide::left : FootSide::right;
  if (Status status = read_roles(container, library); !status) return status;
  std::vector<Foot> feet;
  if (Status status = read_array(container, "FEET", 2, feet); !status) return status;
  for (std::size_t f = 0; f < 2; ++f) {
    library.feet[f] = {feet[f].joint, vector(feet[f].heel), vector(feet[f].forward), feet[f].length,
                       static_cast<double>(feet[f].toe_out)};
  }
  auto keytimes = read_texts(container, "KEYNAMES", info.keytimes);
  if (!keytimes) return keytimes.error();
  library.keytimes = *std::move(keytimes);
  std::vector<ParameterRecord> records;
  if (Status status = read_array(container, "PARAMS", info.parameters, records); !status)
    return status;
  for (const ParameterRecord& record : records) {
    if (record.quantity > static_cast<std::uint32_t>(parametric::Quantity::path_turn) ||
        record.direction > static_cast<std::uint32_t>(parametric::Direction::along)) {
      return invalid(container, "PARAMS", "has a parameter of unknown kind");
    }
    library.parameters.push_back(
        {static_cast<parametric::Quantity>(record.quantity), record.keytime, record.joint,
         static_cast<parametric::Direction>(record.direction), record.tolerance});
  }
  return {};
}

// Counts frames and contacts of all examples before memory is allocated.
struct Totals {
  std::uint64_t frames = 0, contacts = 0;
};
Result<Totals> totals_of(const ContainerReader& container,
                         const std::vector<ExampleRecord>& records) {
  Totals totals;
  for (const ExampleRecord& record : records) {
    totals.frames += record.frames;
    totals.contacts += record.contacts;
    if ((record.flags & ~kMirrored) != 0 || record.frames == 0 ||
        record.frames > static_cast<std::uint32_t>(std::numeric_limits<int>::max())) {
      return invalid(container, "EXAMPLES", "has an example without frames or with unknown flags");
    }
  }
  return totals;
}

void read_motion(const std::byte* bytes, OrientationEncoding encoding, Clip& motion) {
  const std::size_t size = transform_size(encoding);
  for (std::size_t i = 0; i < motion.positions.size(); ++i) {
    Quat orientation;
    read_transform(bytes + i * size, encoding, motion.positions[i], orientation);
    motion.orientations[i] = orientation.cast<float>();
  }
}

Status read_examples(const ContainerReader& container, const Info& info, Library& library) {
  std::vector<ExampleRecord> records;
  std::vector<double> keytimes, measured;
  std::vector<ContactRecord> contacts;
  if (Status status = read_array(container, "EXAMPLES", info.examples, records); !status)
    return status;
  const auto totals = totals_of(container, records);
  if (!totals) return totals.error();
  Status status =
      read_array(container, "KEYTIMES", std::uint64_t{info.examples} * info.keytimes, keytimes);
  if (status) {
    status =
        read_array(container, "MEASURED", std::uint64_t{info.examples} * info.parameters, measured);
  }
  if (status) status = read_array(container, "CONTACTS", totals->contacts, contacts);
  if (!status) return status;
  auto names = read_texts(container, "EXNAMES", info.examples);
  if (!names) return names.error();
  std::vector<std::string> styles(info.examples);
  if (container.find("EXSTYLES")) {
    auto texts = read_texts(container, "EXSTYLES", info.examples);
    if (!texts) return texts.error();
    styles = *std::move(texts);
  }
  const OrientationEncoding encoding = orientation_encoding(container);
  const std::size_t size = transform_size(encoding);
  const auto frames = container.section("FRAMES", totals->frames * info.joints, size);
  if (!frames) return frames.error();
  std::size_t frame = 0, contact = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    Example& example = library.examples.emplace_back();
    example.name = std::move((*names)[i]);
    example.style = std::move(styles[i]);
    example.mirrored = (records[i].flags & kMirrored) != 0;
    const auto part = [i](const std::vector<double>& all, std::size_t count) {
      const auto from = all.begin() + static_cast<std::ptrdiff_t>(i * count);
      return std::vector<double>(from, from + static_cast<std::ptrdiff_t>(count));
    };
    example.keytimes = part(keytimes, info.keytimes);
    example.parameters = part(measured, info.parameters);
    example.motion.skeleton = library.skeleton;
    example.motion.rate = records[i].rate;
    example.motion.resize(static_cast<int>(records[i].frames));
    read_motion(&frames->bytes[frame * info.joints * size], encoding, example.motion);
    frame += records[i].frames;
    for (std::uint32_t c = 0; c < records[i].contacts; ++c, ++contact) {
      const ContactRecord& record = contacts[contact];
      example.contacts.push_back({record.joint, record.start, record.end, vector(record.place)});
    }
  }
  return {};
}

Result<rbf::WeightFunction> read_weights(const ContainerReader& container, const Info& info) {
  const auto section = container.section("WEIGHTS", 1, sizeof(WeightsInfo));
  if (!section) return section.error();
  const auto record = ByteReader(section->bytes).read<WeightsInfo>();
  const std::uint64_t n = info.examples, d = info.parameters, m = record.centres;
  if (record.kernel > static_cast<std::uint32_t>(rbf::Kernel::wendland) || m < n ||
      m > static_cast<std::uint64_t>(rbf::kMaxCentres)) {
    return invalid(container, "WEIGHTS",
                   fmt::format("has invalid values: kernel {} and {} centres for {} examples",
                               record.kernel, m, n));
  }
  rbf::WeightFunction weights;
  weights.kernel = static_cast<rbf::Kernel>(record.kernel);
  weights.dimensions = static_cast<int>(d);
  weights.examples = static_cast<int>(n);
  std::vector<double> ranges;
  Status status = read_array(container, "RANGES", 2 * d, ranges);
  if (status) status = read_array(container, "CENTRES", m * d, weights.centres);
  if (status && container.find("RADII")) status = read_array(container, "RADII", m, weights.radii);
  std::vector<double> smoothing;
  if (status && container.find("SMOOTH")) status = read_array(container, "SMOOTH", 1, smoothing);
  if (!smoothing.empty()) weights.smoothing = smoothing.front();
  if (status) status = read_array(container, "INSERTED", (m - n) * n, weights.inserted_rows);
  if (status) status = read_array(container, "AFFINE", (d + 1) * n, weights.affine);
  if (status) status = read_array(container, "COEFFS", m * n, weights.coefficients);
  if (!status) return status.error();
  const auto middle = ranges.begin() + static_cast<std::ptrdiff_t>(d);
  weights.lower.assign(ranges.begin(), middle);
  weights.upper.assign(middle, ranges.end());
  if (Status step = weights.check(); !step) {
    return at_section(std::move(step).error(), container, "WEIGHTS");
  }
  return weights;
}

// The section of an error, by its code.
std::string_view section_of(const std::string& code) {
  if (code.starts_with("clip")) return "FRAMES";
  if (code == "parametric-feet") return "FEET";
  if (code.starts_with("role") || code == "parametric-roles") return "ROLES";
  if (code == "parametric-parameter") return "PARAMS";
  if (code == "parametric-keytimes") return "KEYTIMES";
  if (code.starts_with("keys")) return "CONTACTS";
  if (code == "steps-report") return "REPORT";
  return "MEASURED";
}

}  // namespace

Result<StepsFile> read(std::span<const std::byte> file) {
  const auto container = ContainerReader::open(file, kStepsFormat);
  if (!container) return container.error();
  const auto info = read_info(*container);
  if (!info) return info.error();
  StepsFile steps;
  if (Status status = read_frame(*container, *info, steps.library); !status) return status.error();
  // Checked before each example gets its own skeleton.
  if (Status status = check_names(steps.library.skeleton, info->examples); !status) {
    return at_section(std::move(status).error(), *container, "INFO");
  }
  if (Status status = read_examples(*container, *info, steps.library); !status)
    return status.error();
  if (container->find("WEIGHTS")) {
    auto weights = read_weights(*container, *info);
    if (!weights) return weights.error();
    steps.weights = *std::move(weights);
  }
  if (const auto report = container->find("REPORT")) {
    steps.report.assign(reinterpret_cast<const char*>(report->bytes.data()), report->bytes.size());
  }
  auto provenance = read_provenance(*container);
  if (!provenance) return provenance.error();
  steps.provenance = *std::move(provenance);
  if (Status status = check(steps); !status) {
    const std::string_view section = section_of(status.error().code);
    return at_section(std::move(status).error(), *container, section);
  }
  return steps;
}

std::vector<std::string> parameter_names(const StepsFile& steps) {
  const parametric::Library& library = steps.library;
  const auto report = parse_json(steps.report);
  const auto list = report.is_object() ? report.value("parameters", nlohmann::json::array())
                                       : nlohmann::json::array();
  std::vector<std::string> names;
  for (std::size_t d = 0; d < library.parameters.size(); ++d) {
    const std::string measures = name_of(library.parameters[d], library.skeleton, library.keytimes);
    names.push_back(measures.substr(measures.rfind('.') + 1));
    if (!list.is_array() || d >= list.size() || !list[d].is_object()) continue;
    const auto name = list[d].find("name");
    if (name != list[d].end() && name->is_string()) names.back() = name->get<std::string>();
  }
  return names;
}

}  // namespace krok::steps
