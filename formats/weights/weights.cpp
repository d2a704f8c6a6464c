#include "formats/weights/weights.h"

#include "core/text.h"
#include "formats/weights/weights_internal.h"

namespace krok::weights {

Result<WeightFile> read(std::string_view text, const std::string& path,
                        std::span<const std::string> targets) {
  const bool is_json = trimmed(without_byte_order_mark(text)).starts_with('{');
  if (!is_json) return read_table(text, path, targets);
  auto file = read_keys(text, targets);
  if (!file) return std::move(file).error().in_file(path);
  return file;
}

Result<MorphWeights> read_weights(std::string_view text, const std::string& path,
                                  const MorphSet& morphs, std::optional<double> rate) {
  const auto file = read(text, path, morphs.names);
  if (!file) return file.error();
  const double chosen = rate.value_or(file->rate.value_or(kUsualRate));
  const auto frames = frames_of(file->curves, chosen);
  if (!frames) return Error(frames.error()).in_file(path);
  auto weights = sample(file->curves, chosen, *frames);
  if (!weights) return std::move(weights).error().in_file(path);
  return weights;
}

}  // namespace krok::weights
