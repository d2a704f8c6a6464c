#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "formats/timeline/fields_internal.h"
#include "timeline/timeline.h"

namespace krok::timeline_file {

// Reads the entries of "base" and "layers" of a timeline.
class Items {
 public:
  // `rate`: of the result, 0 if not in the file. All arguments must outlive this.
  Items(std::string_view text, const std::string& path, const Fields& fields,
        const std::vector<std::string>& source_names, const double& rate);

  Result<timeline::BaseItem> base_item(const json::Value& value, bool is_first) const;
  Result<timeline::Layer> layer(const json::Value& value, std::size_t number) const;

  Location place_of(const json::Value& value) const;

 private:
  Status read_play(const json::Value& item, std::string_view what, std::string& name,
                   timeline::Play& play, std::vector<timeline::Mark>& marks) const;
  Result<timeline::Mark> mark(const json::Value& value) const;
  Result<GroundFrame> ground_frame(const json::Value& value) const;
  Result<timeline::Change> change(const Field& field) const;
  Status check_change_keys(const json::Value& value, timeline::ChangeKind kind) const;
  Result<timeline::Easing> easing(const Field& field) const;
  Result<timeline::Fade> fade(const Field& field) const;
  Result<blend::WeightCurve> weight(const Field& field) const;
  Result<timeline::LayerItem> layer_item(const json::Value& value) const;
  Result<timeline::MaskRule> rule(const json::Value& value) const;

  std::vector<std::size_t> lines_;  // offsets of the lines
  const std::string& path_;
  const Fields& fields_;
  const std::vector<std::string>& source_names_;
  const double& rate_;
};

}  // namespace krok::timeline_file
