#include <fmt/format.h>

#include <algorithm>

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

std::vector<Foot> feet_of(const Library& library) {
  std::vector<Foot> feet;
  for (const auto& foot : library.feet) {
    feet.push_back({foot.joint, 0, numbers(foot.heel), numbers(foot.forward), foot.length});
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
  if (Status done = container.begin("FRAMES"); !done) return done;
  for (const Example& example : library.examples) {
    std::vector<std::byte> bytes(example.motion.positions.size() * transform_size(encoding));
    write_transforms(example.motion.positions, example.motion.orientations, encoding, bytes.data());
    if (Status done = container.append(bytes); !done) return done;
  }
  return {};
}

Status write_examples(const Library& library, OrientationEncoding encoding,
                      ContainerWriter& container) {
  std::vector<ExampleRecord> records;
  std::vector<std::string> names;
  std::vector<double> keytimes, measured;
  std::vector<ContactRecord> contacts;
  for (const Example& example : library.examples) {
    records.push_back(
        {example.motion.rate, static_cast<std::uint32_t>(example.motion.frame_count()),
         static_cast<std::uint32_t>(example.contacts.size()), example.mirrored ? kMirrored : 0, 0});
    names.push_back(example.name);
    keytimes.insert(keytimes.end(), example.keytimes.begin(), example.keytimes.end());
    measured.insert(measured.end(), example.parameters.begin(), example.parameters.end());
    for (const Contact& contact : example.contacts) {
      contacts.push_back({contact.joint, 0, contact.start, contact.end, numbers(contact.place)});
    }
  }
  Status done = container.section("EXAMPLES", bytes_of(records));
  if (done) done = write_texts("EXNAMES", names, container);
  if (done) done = container.section("KEYTIMES", bytes_of(keytimes));
  if (done) done = container.section("MEASURED", bytes_of(measured));
  if (done) done = container.section("CONTACTS", bytes_of(contacts));
  if (done) done = write_frames(library, encoding, container);
  return done;
}

std::size_t weight_sections(const rbf::WeightFunction& weights) {
  return 6 + (weights.radii.empty() ? 0u : 1u) + (weights.smoothing > 0 ? 1u : 0u);
}

Status write_weights(const rbf::WeightFunction& weights, ContainerWriter& container) {
  const WeightsInfo info = {static_cast<std::uint32_t>(weights.kernel), 0,
                            static_cast<std::uint64_t>(weights.centre_count())};
  std::vector<double> ranges = weights.lower;
  ranges.insert(ranges.end(), weights.upper.begin(), weights.upper.end());
  Status done = container.section("WEIGHTS", std::as_bytes(std::span(&info, 1)));
  if (done) done = container.section("RANGES", bytes_of(ranges));
  if (done) done = container.section("CENTRES", bytes_of(weights.centres));
  if (done && !weights.radii.empty()) done = container.section("RADII", bytes_of(weights.radii));
  if (done && weights.smoothing > 0) {
    done = container.section("SMOOTH", std::as_bytes(std::span(&weights.smoothing, 1)));
  }
  if (done) done = container.section("INSERTED", bytes_of(weights.inserted_rows));
  if (done) done = container.section("AFFINE", bytes_of(weights.affine));
  if (done) done = container.section("COEFFS", bytes_of(weights.coefficients));
  return done;
}

bool all_storable(std::span<const std::string> texts) {
  return std::ranges::all_of(texts, is_storable_text);
}

}  // namespace

Status detail::check_names(const Skeleton& skeleton, std::uint64_t examples) {
  std::uint64_t bytes = 0;
  for (const std::string& name : skeleton.names) bytes += name.size();
  if (bytes <= kMostNames / std::max<std::uint64_t>(examples, 1)) return {};
  return shape(
      fmt::format("{} bytes of joints' names are too many for {} examples", bytes, examples));
}

Status check(const StepsFile& steps) {
  const Library& library = steps.library;
  if (Status sound = check_storable(library.skeleton); !sound) return sound;
  if (Status fits = check_names(library.skeleton, library.examples.size()); !fits) return fits;
  if (Status sound = parametric::check(library); !sound) return sound;
  if (library.examples.empty() || library.examples.size() > kMostExamples ||
      library.keytimes.size() > kMostKeytimes || library.parameters.size() > kMostParameters) {
    return shape(
        fmt::format("{} examples, {} keytimes and {} parameters; a file holds 1 to {}, "
                    "2 to {} and 1 to {}",
                    library.examples.size(), library.keytimes.size(), library.parameters.size(),
                    kMostExamples, kMostKeytimes, kMostParameters));
  }
  std::vector<std::string> names = library.keytimes;
  for (const Example& example : library.examples) names.push_back(example.name);
  if (!all_storable(names)) {
    return shape("the name of an example or keytime is no valid UTF-8 or has a zero byte");
  }
  if (steps.weights) {
    if (Status sound = steps.weights->check(); !sound) return sound;
    if (steps.weights->examples != static_cast<int>(library.examples.size()) ||
        steps.weights->dimensions != library.dimensions()) {
      return shape("the weights are for another number of examples or parameters");
    }
  }
  if (steps.report.empty()) return {};
  const auto json = parse_json(steps.report);
  if (steps.report.size() <= kMostReport && json.is_object()) return {};
  return Error("steps-report", "the report is no JSON object, or longer than 16 MiB");
}

Status write(const StepsFile& steps, const WriteOptions& options, OutputFile& file) {
  if (Status holds = check(steps); !holds) return holds;
  const Library& library = steps.library;
  const Info info = {library.rate,
                     static_cast<std::uint32_t>(library.skeleton.names.size()),
                     static_cast<std::uint32_t>(library.keytimes.size()),
                     static_cast<std::uint32_t>(library.parameters.size()),
                     static_cast<std::uint32_t>(library.examples.size()),
                     static_cast<std::uint32_t>(library.swing),
                     0};
  std::size_t sections = 12 + kSkeletonSections;
  if (steps.weights) sections += weight_sections(*steps.weights);
  ContainerWriter container(file, kStepsFormat, orientation_flags(options.orientation), sections);
  Status done = container.section("INFO", std::as_bytes(std::span(&info, 1)));
  if (done) done = write_skeleton(library.skeleton, options.orientation, container);
  if (done) done = container.section("FEET", bytes_of(feet_of(library)));
  if (done) done = write_texts("KEYNAMES", library.keytimes, container);
  if (done) done = container.section("PARAMS", bytes_of(parameters_of(library)));
  if (done) done = write_examples(library, options.orientation, container);
  if (done && steps.weights) done = write_weights(*steps.weights, container);
  if (done) done = container.section("REPORT", std::as_bytes(std::span(steps.report)));
  if (done) done = write_provenance(steps.provenance, container);
  if (done) done = container.finish();
  return done;
}

}  // namespace krok::steps
