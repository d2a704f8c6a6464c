#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/numbers.h"
#include "formats/assimp/collada_text_internal.h"
#include "formats/assimp/curve_internal.h"

namespace krok::assimp {

namespace {

constexpr std::string_view kEndOfSampler = "</sampler>";

// Of a reference, "#id", in the same file.
std::string id_of(std::string_view tag, std::string_view name) {
  const std::string reference = attribute(tag, name);
  return reference.substr(reference.starts_with('#') ? 1 : 0);
}

struct ColladaSampler {
  std::string_view text;                               // the element
  std::map<std::string, std::string_view> contents{};  // by semantic, of the list
};

struct ColladaChannel {
  std::string_view tag, sampler;  // the sampler's element
  std::string id;                 // the sampler's
  bool shares = false;            // it is another channel's before
};

// By id.
std::map<std::string, ColladaSampler> samplers_of(std::string_view text) {
  std::map<std::string, std::string_view> lists;  // by id
  for_each_tag(text, "<source", [&](std::string_view tag, std::string_view rest) {
    const std::string_view source = rest.substr(0, rest.find("</source"));
    for (const char* kind : {"<float_array", "<Name_array"}) {
      for_each_tag(source, kind, [&](std::string_view, std::string_view content) {
        lists[attribute(tag, "id")] = content.substr(0, content.find('<'));
      });
    }
  });
  std::map<std::string, ColladaSampler> samplers;
  for_each_tag(text, "<sampler", [&](std::string_view tag, std::string_view rest) {
    const std::size_t end = rest.find(kEndOfSampler);
    if (tag.ends_with('/') || end == std::string_view::npos) return;
    const std::size_t size = tag.size() + 1 + end + kEndOfSampler.size();
    ColladaSampler& sampler = samplers[attribute(tag, "id")];
    sampler.text = std::string_view(tag.data(), size);
    for_each_tag(sampler.text, "<input", [&](std::string_view input, std::string_view) {
      sampler.contents[attribute(input, "semantic")] = lists[id_of(input, "source")];
    });
  });
  return samplers;
}

Curve curve_of(ColladaSampler& sampler, double& unknown_gap) {
  Curve curve{.times = numbers_of(sampler.contents["INPUT"]),
              .values = numbers_of(sampler.contents["OUTPUT"]),
              .segments = {}};
  const auto shapes = words_of(sampler.contents["INTERPOLATION"]);
  const std::size_t keys = curve.times.size();
  if (keys == 0 || curve.values.size() != keys) {
    // Matrices and vectors: the importer's interpolation is theirs unless they have tangents.
    const bool straight = std::ranges::all_of(shapes, [](auto shape) { return shape == "LINEAR"; });
    for (std::size_t k = 1; k < keys && !straight; ++k) {
      unknown_gap = std::max(unknown_gap, curve.times[k] - curve.times[k - 1]);
    }
    return {};
  }
  const auto into = numbers_of(sampler.contents["IN_TANGENT"]);
  const auto out = numbers_of(sampler.contents["OUT_TANGENT"]);
  curve.segments.resize(keys - 1);
  for (std::size_t k = 0; k + 1 < keys && k < shapes.size(); ++k) {
    Segment& segment = curve.segments[k];
    const double gap = curve.times[k + 1] - curve.times[k];
    // Time and value, or the value alone, a third of the gap away.
    const auto point = [&](const std::vector<double>& points, std::size_t key, double side) {
      if (points.size() == 2 * keys) return Vec2(points[2 * key], points[2 * key + 1]);
      const double value = points.size() == keys ? points[key] : curve.values[key];
      return Vec2(curve.times[key] + side * gap / 3, value);
    };
    if (shapes[k] == "BEZIER") {
      segment = {Shape::bezier, point(out, k, 1), point(into, k + 1, -1)};
    } else if (shapes[k] == "STEP") {
      segment.shape = Shape::hold;
    } else if (shapes[k] != "LINEAR") {
      unknown_gap = std::max(unknown_gap, gap);
    }
  }
  return curve;
}

// The rotations of nodes, as lists of their turns; `curves` by target.
std::vector<std::vector<Turn>> rotations_of(std::string_view text,
                                            const std::map<std::string, int>& curves) {
  std::vector<std::vector<Turn>> rotations;
  for_each_tag(text, "<node", [&](std::string_view tag, std::string_view rest) {
    const std::size_t end = std::min(rest.find("<node"), rest.find("</node"));
    std::vector<Turn>& turns = rotations.emplace_back();
    for_each_tag(rest.substr(0, end), "<rotate",
                 [&](std::string_view turn, std::string_view after) {
                   const auto numbers = numbers_of(after.substr(0, after.find('<')));
                   if (numbers.size() != 4) return;
                   const Vec3 axis(numbers[0], numbers[1], numbers[2]);
                   if (!(axis.norm() > 1e-6) || !axis.allFinite()) return;
                   const auto curve =
                       curves.find(attribute(tag, "id") + "/" + attribute(turn, "sid") + ".ANGLE");
                   turns.push_back(
                       {axis.normalized(), numbers[3], curve == curves.end() ? -1 : curve->second});
                 });
  });
  return rotations;
}

}  // namespace

ResampledFile resample_collada(std::string_view text) {
  auto samplers = samplers_of(text);
  double metres = 1;
  for_each_tag(text, "<unit", [&](std::string_view tag, std::string_view) {
    metres = parse_finite(attribute(tag, "meter")).value_or(1);
  });
  CurveSet set;
  std::vector<ColladaChannel> channels;  // [curves]
  std::set<std::string> used;            // samplers
  std::map<std::string, int> targets;
  for_each_tag(text, "<channel", [&](std::string_view tag, std::string_view) {
    const std::string id = id_of(tag, "source");
    const auto sampler = samplers.find(id);
    if (sampler == samplers.end()) return;
    const std::string target = attribute(tag, "target");
    targets[target] = static_cast<int>(set.curves.size());
    set.curves.push_back(curve_of(sampler->second, set.result.gap));
    const bool moves = target.size() > 2 && target[target.size() - 2] == '.';
    set.curves.back().metres = moves ? metres : 0;  // .X, .Y or .Z of a translation
    channels.push_back({tag, sampler->second.text, id, !used.insert(id).second});
  });
  set.rotations = rotations_of(text, targets);
  resample(set);
  ResampledFile result{.text = {}, .result = set.result};
  const auto place_of = [&](std::string_view part) {
    return static_cast<std::size_t>(part.data() - text.data());
  };
  struct Replacement {
    std::string by;
    std::size_t end;
  };
  std::map<std::size_t, Replacement> replaced;  // by place
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const ColladaChannel& channel = channels[c];
    const Curve& curve = set.curves[c];
    if (!curve.changed && !channel.shares) continue;
    std::string sources, inputs;
    const auto add = [&](const char* semantic, const std::vector<double>& numbers) {
      sources += fmt::format(
          "<source id=\"krok-{0}-{1}\"><float_array id=\"krok-{0}-{1}-list\" count=\"{2}\">"
          "{3:.12g}</float_array><technique_common><accessor source=\"#krok-{0}-{1}-list\" "
          "count=\"{2}\" stride=\"1\"><param type=\"float\"/></accessor></technique_common>"
          "</source>",
          c, semantic, numbers.size(), fmt::join(numbers, " "));
      inputs += fmt::format("<input semantic=\"{1}\" source=\"#krok-{0}-{1}\"/>", c, semantic);
    };
    const std::size_t content = channel.sampler.find('>') + 1;
    if (curve.changed) {
      add("INPUT", curve.times);
      add("OUTPUT", curve.values);
      inputs += kEndOfSampler;
    } else {
      inputs = channel.sampler.substr(content);
    }
    std::string tag(channel.sampler.substr(0, content));
    if (!channel.shares) {
      const std::size_t place = place_of(channel.sampler);
      replaced[place] = {sources.append(tag).append(inputs), place + channel.sampler.size()};
      continue;
    }
    // The importer gives a sampler to its last channel alone: each further one gets a copy.
    std::string own(channel.tag);
    const std::size_t reference = own.find('#' + channel.id, own.find("source"));
    if (reference == std::string::npos) continue;
    own.replace(reference + 1, channel.id.size(), fmt::format("krok-{}", c));
    replaced[place_of(channel.tag)] = {
        fmt::format("{}<sampler id=\"krok-{}\">{}{}", sources, c, inputs, own),
        place_of(channel.tag) + channel.tag.size()};
  }
  std::size_t taken = 0;
  for (const auto& [place, replacement] : replaced) {
    result.text.append(text.substr(taken, place - taken)).append(replacement.by);
    taken = replacement.end;
  }
  if (!replaced.empty()) result.text += text.substr(taken);
  return result;
}

}  // namespace krok::assimp
