#include "tools/krok-mix/face.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "core/text.h"
#include "face/visemes.h"
#include "formats/textgrid/textgrid.h"
#include "formats/weights/weights.h"
#include "tools/cli/paths.h"

namespace krok::cli::mix {

namespace {

using timeline_file::FaceItem;

class FaceMaker {
 public:
  FaceMaker(const std::string& path, const Actor& character, const Clip& clip, ToolContext& context)
      : folder_(folder_of(path)),
        targets_(character.morphs.names),
        clip_(clip),
        context_(context) {}

  Result<face::Item> item(const FaceItem& given) {
    Result<face::Item> made = unplaced(given);
    if (!made) {
      if (made.error().where.line == 0) made.error().where = given.where;
      return made;
    }
    made->start = given.at.seconds(clip_.rate);
    made->end = given.until ? given.until->seconds(clip_.rate)
                            : std::min(clip_.duration(), made->start + duration_);
    made->fade_in = given.fade_in;
    made->fade_out = given.fade_out;
    made->weight = given.weight;
    made->additive = given.additive;
    return made;
  }

 private:
  Result<face::Item> unplaced(const FaceItem& given) {
    duration_ = clip_.duration();
    switch (given.kind) {
      case FaceItem::Kind::weights:
        return curves(given);
      case FaceItem::Kind::expression:
        return expression(given);
      case FaceItem::Kind::phonemes:
        return speech(given);
      case FaceItem::Kind::blinks:
        return blinks(given);
    }
    return Error("timeline-value", "an unknown item of the face");
  }

  Result<std::size_t> target(const std::string& name) const {
    const auto found = std::ranges::find(targets_, name);
    if (found != targets_.end()) return static_cast<std::size_t>(found - targets_.begin());
    return Error("timeline-target",
                 fmt::format("the character has no expression '{}'", shown(name)),
                 nearest_hint(name, targets_));
  }

  // Of one target, which has the weight 1 at all times.
  Result<face::Item> expression(const FaceItem& given) const {
    const auto moved = target(given.target);
    if (!moved) return moved.error();
    MorphCurves curves{targets_, std::vector<MorphCurve>(targets_.size())};
    curves.curves[*moved] = {{0.0}, {1.0}, {}};
    return face::item_of(std::move(curves));
  }

  // The error has its place in the timeline and the file's name.
  static Error missing(const std::string& path, Error error) {
    error.message = fmt::format("{}: {}", shown(path), error.message);
    return error;
  }

  Result<face::Item> curves(const FaceItem& given) {
    const std::string path = below(folder_, given.file);
    const auto file = context_.open_input(path);
    if (!file) return missing(path, file.error());
    auto weights = weights::read(file->text(), path, targets_);
    if (!weights) return weights.error();
    if (auto warning = weights::implausible_weight(weights->curves)) {
      context_.diagnose_in(path, {*std::move(warning)});
    }
    return face::item_of(std::move(weights->curves));
  }

  Result<face::Item> blinks(const FaceItem& given) const {
    auto item = expression(given);
    if (!item) return item;
    const auto moved = *target(given.target);
    item->at = [moved, options = given.blinks, times = face::blink_times(duration_, given.blinks)](
                   double seconds, std::span<double> weights) {
      weights[moved] = face::blink_at(seconds, times, options);
    };
    return item;
  }

  // The given shapes; a viseme without one is the expression of its name, or viseme_NAME.
  Result<std::vector<face::Shape>> shapes(const FaceItem& given,
                                          std::span<const face::Phoneme> phonemes,
                                          face::Alphabet alphabet) const {
    std::vector<char> is_used(face::viseme_names().size(), 0);
    for (const face::Phoneme& phoneme : phonemes) {
      const auto visemes = face::visemes_of(phoneme.label, alphabet);
      if (!visemes) continue;  // refused by the track
      for (const std::size_t v : *visemes) is_used[v] = 1;
    }
    std::vector<face::Shape> all;
    for (std::size_t v = 0; v < is_used.size(); ++v) {
      face::Shape& shape = all.emplace_back(targets_.size(), 0.0);
      const std::string name(face::viseme_names()[v]);
      const auto own = std::ranges::find(given.shapes, name, &FaceItem::Shape::viseme);
      if (own == given.shapes.end()) {
        auto usual = target(name);
        if (!usual) usual = target("viseme_" + name);
        if (usual) shape[*usual] = 1;
        if (usual || is_used[v] == 0) continue;
        return Error("timeline-shape",
                     fmt::format("the character has no expression '{0}' or 'viseme_{0}', which the "
                                 "phonemes need",
                                 name),
                     fmt::format("add \"shapes\": {{\"{}\": {{\"EXPRESSION\": 1}}}}", name));
      }
      double sum = 0;
      for (const auto& [target_name, weight] : own->weights) {
        const auto moved = target(target_name);
        if (!moved) return moved.error();
        shape[*moved] = weight;
        sum += weight;
      }
      if (sum > 1 + 1e-9) {
        return Error("timeline-shape",
                     fmt::format("the weights of the shape of '{}' are more than 1 in sum", name));
      }
    }
    return all;
  }

  Result<face::Item> speech(const FaceItem& given) {
    const std::string path = below(folder_, given.file);
    const auto file = context_.open_input(path);
    if (!file) return missing(path, file.error());
    auto intervals = textgrid::read_intervals(file->text(), path, given.tier);
    if (!intervals) return intervals.error();
    std::vector<face::Phoneme> phonemes;
    for (textgrid::Interval& one : *intervals) {
      for (const auto& [label, symbol] : given.symbols) {
        if (one.label != label) continue;
        one.label = symbol;
        break;
      }
      phonemes.push_back({one.start, one.end, std::move(one.label), std::move(one.where)});
    }
    const face::Alphabet alphabet =
        given.alphabet == face::Alphabet::automatic ? face::alphabet_of(phonemes) : given.alphabet;
    const auto shapes_of_visemes = shapes(given, phonemes, alphabet);
    if (!shapes_of_visemes) return shapes_of_visemes.error();
    const double frame = 1 / clip_.rate;
    auto track = face::VisemeTrack::create(phonemes, alphabet, *shapes_of_visemes, 1.001 * frame);
    if (!track) return track.error();
    face::Item item;
    item.has.assign(targets_.size(), 0);
    for (const face::Shape& shape : *shapes_of_visemes) {
      for (std::size_t t = 0; t < shape.size(); ++t) {
        if (shape[t] > 0) item.has[t] = 1;
      }
    }
    item.at = [shared = std::make_shared<const face::VisemeTrack>(*std::move(track))](
                  double seconds, std::span<double> weights) { shared->at(seconds, weights); };
    return item;
  }

  static std::string folder_of(const std::string& path) {
    const std::size_t slash = path.rfind('/');
    return slash == std::string::npos ? std::string() : path.substr(0, slash + 1);
  }

  std::string folder_;
  const std::vector<std::string>& targets_;
  const Clip& clip_;
  ToolContext& context_;
  double duration_ = 0;
};

}  // namespace

Result<std::vector<krok::ik::GazeFacts>> add_gaze(const timeline_file::Document& document,
                                                  const Actor& character, const RoleMap& roles,
                                                  Clip& clip) {
  if (document.gaze.empty()) return std::vector<krok::ik::GazeFacts>();
  const auto eyes = krok::ik::gaze_eyes(character.eyes, character.skeleton(), clip.skeleton);
  if (!eyes) return eyes.error();
  std::vector<krok::ik::GazeTarget> targets;
  for (const timeline_file::GazeKey& key : document.gaze) {
    targets.push_back({key.at.seconds(clip.rate), key.target});
  }
  auto made = krok::ik::apply_gaze(clip, *eyes, targets, roles);
  if (!made) return made.error();
  clip = std::move(made->clip);
  return std::move(made->targets);
}

Result<MorphWeights> face_of(const timeline_file::Document& document, const std::string& path,
                             const Actor& character, const Clip& clip, ToolContext& context) {
  FaceMaker maker(path, character, clip, context);
  std::vector<face::Item> items;
  // Below all items, what the character has at rest.
  MorphCurves rest{character.morphs.names, std::vector<MorphCurve>(character.morphs.names.size())};
  for (std::size_t t = 0; t < character.rest_weights.size(); ++t) {
    if (character.rest_weights[t] == 0) continue;
    rest.curves[t] = {{0.0}, {static_cast<double>(character.rest_weights[t])}, {}};
  }
  items.push_back(face::item_of(std::move(rest)));
  items.back().end = clip.duration();
  for (const FaceItem& given : document.face) {
    auto item = maker.item(given);
    if (!item) return std::move(item).error().in_file(path);
    items.push_back(*std::move(item));
  }
  return face::mix(character.morphs.names, items, clip.rate, clip.frame_count());
}

}  // namespace krok::cli::mix
