#include <fmt/format.h>

#include <algorithm>

#include "core/index.h"
#include "core/json_internal.h"
#include "formats/container/sections.h"
#include "formats/steps/records_internal.h"
#include "formats/steps/steps.h"

namespace krok::steps {

namespace {

using namespace detail;
using parametric::Example;
using parametric::Library;

Error shape(std::string message) {
  return {"steps-shape", std::move(message)};
}

template <typename T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

std::array<double, 3> numbers(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

// [joints] the roles that were given, empty texts for the others; nothing if none was.
std::vector<std::string> roles_in(const Library& library) {
  if (library.given_roles.empty()) return {};
  const RoleMap roles = parametric::roles_of(library);
  std::vector<std::string> labels(library.skeleton.names.size());
  for (const GivenRole& given : library.given_roles) {
    labels[at(given.joint)] = role_label(roles, given.joint);
  }
  return labels;
}

std::vector<Foot> feet_of(const Library& library) {
  std::vector<Foot> feet;
  for (const auto& foot : library.feet) {
    feet.push_back({foot.joint, static_cast<float>(foot.toe_out), numbers(foot.heel),
                    numbers(foot.forward), foot.length});
  }
  return feet;
}

std::vector<ParameterRecord> parameters_of(const Library& library) {
  std::vector<ParameterRecord> records;
  for (const auto& parameter : library.parameters) {
    records.push_back({static_cast<std::uint32_t>(parameter.quantity), parameter.keytime,
                       parameter.joint, static_cast<std::uint32_t>(parameter.direction),
                       parameter.tolerance});
  }
  return records;
}

Status write_frames(const Library& library, OrientationEncoding encoding,
                    ContainerWriter& container) {
  if (Status status = container.begin("FRAMES"); !status) return status;
  for (const Example& example : library.examples) {
    std::vector<std::byte> bytes(example.motion.positions.size() * transform_size(encoding));
    write_transforms(example.motion.positions, example.motion.orientations, encoding, bytes.data());
    if (Status status = container.append(bytes); !status) return status;
  }
  return {};
}

bool has_styles(const Library& library) {
  return !std::ranges::all_of(library.examples, &std::string::empty, &Example::style);
}

Status write_examples(const Library& library, OrientationEncoding encoding,
                      ContainerWriter& container) {
  std::vector<ExampleRecord> records;
  std::vector<std::string> names, styles;
  std::vector<double> keytimes, measured;
  std::vector<ContactRecord> contacts;
  for (const Example& example : library.examples) {
    records.push_back(
        {example.motion.rate, static_cast<std::uint32_t>(example.motion.frame_count()),
         static_cast<std::uint32_t>(example.contacts.size()), example.mirrored ? kMirrored : 0, 0});
    names.push_back(example.name);
    styles.push_back(example.style);
    keytimes.insert(keytimes.end(), example.keytimes.begin(), example.keytimes.end());
    measured.insert(measured.end(), example.parameters.begin(), example.parameters.end());
    for (const Contact& contact : example.contacts) {
      contacts.push_back({contact.joint, 0, contact.start, contact.end, numbers(contact.place)});
    }
  }
  Status status = container.section("EXAMPLES", bytes_of(records));
  if (status) status = write_texts("EXNAMES", names, container);
  if (status && has_styles(library)) status = write_texts("EXSTYLES", styles, container);
  if (status) status = container.section("KEYTIMES", bytes_of(keytimes));
  if (status) status = container.section("MEASURED", bytes_of(measured));
  if (status) status = container.section("CONTACTS", bytes_of(contacts));
  if (status) status = write_frames(library, encoding, container);
  return status;
}

std::size_t weight_sections(const rbf::WeightFunction& weights) {
  return 6 + (weights.radii.empty() ? 0u : 1u) + (weights.smoothing > 0 ? 1u : 0u);
}

Status write_weights(const rbf::WeightFunction& weights, ContainerWriter& container) {
  const WeightsInfo info = {static_cast<std::uint32_t>(weights.kernel), 0,
                            static_cast<std::uint64_t>(weights.centre_count())};
  std::vector<double> ranges = weights.lower;
  ranges.insert(ranges.end(), weights.upper.begin(), weights.upper.end());
  Status status = container.section("WEIGHTS", std::as_bytes(std::span(&info, 1)));
  if (status) status = container.section("RANGES", bytes_of(ranges));
  if (status) status = container.section("CENTRES", bytes_of(weights.centres));
  if (status && !weights.radii.empty())
    status = container.section("RADII", bytes_of(weights.radii));
  if (status && weights.smoothing > 0) {
    status = container.section("SMOOTH", std::as_bytes(std::span(&weights.smoothing, 1)));
  }
  if (status) status = container.section("INSERTED", bytes_of(weights.inserted_rows));
  if (status) status = container.section("AFFINE", bytes_of(weights.affine));
  if (status) status = container.section("COEFFS", bytes_of(weights.coefficients));
  return status;
}

bool all_storable(std::span<const std::string> texts) {
  return std::ranges::all_of(texts, is_storable_text);
}

}  // namespace

Status detail::check_names(const Skeleton& skeleton, std::uint64_t examples) {
  std::uint64_t bytes = 0;
  for (const std::string& name : skeleton.names) bytes += name.size();
  if (bytes <= kMaxNames / std::max<std::uint64_t>(examples, 1)) return {};
  return shape(
      fmt::format("{} bytes of joint names are too many for {} examples", bytes, examples));
}

Status check(const StepsFile& steps) {
  const Library& library = steps.library;
  if (Status status = check_storable(library.skeleton); !status) return status;
  if (Status status = check_names(library.skeleton, library.examples.size()); !status)
    return status;
  if (Status status = parametric::check(library); !status) return status;
  if (library.examples.empty() || library.examples.size() > kMaxExamples ||
      library.keytimes.size() > kMaxKeytimes || library.parameters.size() > kMaxParameters) {
    return shape(
        fmt::format("{} examples, {} keytimes and {} parameters; expected 1 to {}, 2 to {} and 1 "
                    "to {}",
                    library.examples.size(), library.keytimes.size(), library.parameters.size(),
                    kMaxExamples, kMaxKeytimes, kMaxParameters));
  }
  std::vector<std::string> names = library.keytimes;
  for (const Example& example : library.examples) {
    names.push_back(example.name);
    names.push_back(example.style);
  }
  if (!all_storable(names)) {
    return shape("the name of an example, style or keytime is not valid UTF-8 or has a zero byte");
  }
  if (steps.weights) {
    if (Status status = steps.weights->check(); !status) return status;
    if (steps.weights->examples != static_cast<int>(library.examples.size()) ||
        steps.weights->dimensions != library.dimensions()) {
      return shape("the weights do not match the number of examples or parameters");
    }
  }
  if (steps.report.empty()) return {};
  const auto json = parse_json(steps.report);
  if (steps.report.size() <= kMaxReport && json.is_object()) return {};
  return Error("steps-report", "the report is not a JSON object, or exceeds 16 MiB");
}

Status write(const StepsFile& steps, const WriteOptions& options, OutputFile& file) {
  if (Status status = check(steps); !status) return status;
  const Library& library = steps.library;
  const Info info = {library.rate,
                     static_cast<std::uint32_t>(library.skeleton.names.size()),
                     static_cast<std::uint32_t>(library.keytimes.size()),
                     static_cast<std::uint32_t>(library.parameters.size()),
                     static_cast<std::uint32_t>(library.examples.size()),
                     static_cast<std::uint32_t>(library.swing),
                     static_cast<float>(library.ground)};
  std::size_t sections = 12 + kSkeletonSections;
  const std::vector<std::string> roles = roles_in(library);
  if (!roles.empty()) ++sections;
  if (has_styles(library)) ++sections;
  if (steps.weights) sections += weight_sections(*steps.weights);
  ContainerWriter container(file, kStepsFormat, orientation_flags(options.orientation), sections);
  Status status = container.section("INFO", std::as_bytes(std::span(&info, 1)));
  if (status) status = write_skeleton(library.skeleton, options.orientation, container);
  if (status && !roles.empty()) status = write_texts("ROLES", roles, container);
  if (status) status = container.section("FEET", bytes_of(feet_of(library)));
  if (status) status = write_texts("KEYNAMES", library.keytimes, container);
  if (status) status = container.section("PARAMS", bytes_of(parameters_of(library)));
  if (status) status = write_examples(library, options.orientation, container);
  if (status && steps.weights) status = write_weights(*steps.weights, container);
  if (status) status = container.section("REPORT", std::as_bytes(std::span(steps.report)));
  if (status) status = write_provenance(steps.provenance, container);
  if (status) status = container.finish();
  return status;
}

}  // namespace krok::steps
