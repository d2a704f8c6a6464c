#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>

#include "formats/assimp/curve_internal.h"
#include "formats/assimp/fbx_elements_internal.h"

namespace krok::assimp {

namespace {

constexpr double kTicksPerSecond = 46186158000.0;

enum FbxKeyFlags : std::uint32_t {
  kConstant = 0x2,
  kLinear = 0x4,
  kConstantNext = 0x100,
  kTcb = 0x200,
  kUser = 0x400,
  kClamp = 0x1000,
  kTimeIndependent = 0x2000,
  kClampProgressive = 0x4000,
  kWeightedOut = 0x1000000,
  kWeightedIn = 0x2000000,
};

struct FbxKey {
  std::uint32_t flags = kLinear;
  // Of the tangents to the next key: slope per second, and part of the gap.
  double slope_out = 0, slope_in = 0, part_out = 1.0 / 3, part_in = 1.0 / 3;

  bool is_automatic() const { return is_curved() && (flags & kUser) == 0; }
  bool is_curved() const { return (flags & (kConstant | kLinear)) == 0; }
};

// `numbers`: both slopes, both parts as integers in the bits of a float, in 1/10000.
FbxKey fbx_key(double flags, const double* numbers, bool ascii) {
  const auto bits = [&](double number) {
    constexpr double kNoFloat = 1 << 23;  // ASCII files have the bits as an integer
    return ascii && std::abs(number) >= kNoFloat
               ? static_cast<std::uint32_t>(static_cast<std::int64_t>(number))
               : std::bit_cast<std::uint32_t>(static_cast<float>(number));
  };
  FbxKey key{.flags = static_cast<std::uint32_t>(static_cast<std::int64_t>(flags)),
             .slope_out = std::bit_cast<float>(bits(numbers[0])),
             .slope_in = std::bit_cast<float>(bits(numbers[1]))};
  if ((key.flags & kWeightedOut) != 0) key.part_out = (bits(numbers[2]) & 0xffff) * 1e-4;
  if ((key.flags & kWeightedIn) != 0) key.part_in = (bits(numbers[2]) >> 16) * 1e-4;
  return key;
}

// The slope at a key whose tangents are left to the program, as Autodesk's programs have it.
double automatic_slope(const Curve& curve, std::size_t k, const std::vector<FbxKey>& keys) {
  const std::uint32_t flags = keys[k].flags;
  const bool first = k == 0, last = k + 1 == keys.size();
  const auto rise = [&](std::size_t i) { return curve.values[i + 1] - curve.values[i]; };
  const auto slope = [&](std::size_t i) { return rise(i) / (curve.times[i + 1] - curve.times[i]); };
  constexpr double kFlat = 1e-3;
  if ((flags & kClamp) != 0 &&
      ((!first && std::abs(rise(k - 1)) < kFlat) || (!last && std::abs(rise(k)) < kFlat))) {
    return 0;
  }
  if (first || last) return (flags & kClampProgressive) != 0 ? 0 : slope(first ? k : k - 1);
  const double in = slope(k - 1), out = slope(k);
  const double part =
      (curve.times[k] - curve.times[k - 1]) / (curve.times[k + 1] - curve.times[k - 1]);
  const double across = part * in + (1 - part) * out;
  const double own = (flags & kTimeIndependent) != 0 ? across : (in + out) / 2;
  if ((flags & kClampProgressive) == 0) return own;
  // So that the curve's inner points are not beyond the neighbouring keys.
  const double sign = own < 0 ? -1 : 1;
  return sign * std::max(0.0, std::min({sign * own, sign * in / std::max(keys[k - 1].part_in, 1e-6),
                                        sign * out / std::max(keys[k].part_out, 1e-6)}));
}

// Segments; also the longest gap of those whose rule is not known well enough.
void shape_segments(Curve& curve, const std::vector<FbxKey>& keys, double& unknown_gap) {
  std::vector<FbxKey> shaped = keys;
  for (std::size_t k = 0; k < keys.size() && keys.size() > 1; ++k) {
    if (!keys[k].is_automatic()) continue;
    shaped[k].slope_out = automatic_slope(curve, k, keys);
    if (k > 0) shaped[k - 1].slope_in = shaped[k].slope_out;
  }
  for (std::size_t k = 0; k + 1 < keys.size(); ++k) {
    const FbxKey& key = shaped[k];
    Segment& segment = curve.segments.emplace_back();
    const double gap = curve.times[k + 1] - curve.times[k];
    if ((key.flags & kConstant) != 0) {
      segment.shape = (key.flags & kConstantNext) != 0 ? Shape::hold_next : Shape::hold;
    }
    if (!key.is_curved()) continue;
    segment.shape = Shape::bezier;
    const double out = gap * key.part_out, in = gap * key.part_in;
    segment.out = Vec2(curve.times[k] + out, curve.values[k] + out * key.slope_out);
    segment.in = Vec2(curve.times[k + 1] - in, curve.values[k + 1] - in * key.slope_in);
    // Tension, continuity and bias, and the automatic tangents' own bias.
    const bool biased = keys[k].is_automatic() && std::abs(keys[k].slope_out) > 1e-4;
    if (biased || (key.flags & kTcb) != 0) unknown_gap = std::max(unknown_gap, gap);
  }
}

// What the file has of curves; ids as in the file.
struct FbxCurves {
  std::vector<std::map<std::string_view, std::size_t>> lists;  // [curves] elements, by name
  std::map<std::string_view, int> index_of;                    // by the curve's id
  struct Node {
    std::array<int, 3> curves = {-1, -1, -1};
    std::string_view model, property;
  };
  std::map<std::string_view, Node> nodes;    // by the id of the AnimationCurveNode
  std::map<std::string_view, int> order_of;  // rotation order of a model
  double metres = 0.01;                      // per unit of length
  bool pivots = false;
};

FbxCurves find_curves(const FbxElements& file) {
  FbxCurves found;
  std::string_view object;
  const auto is_named = [](std::string_view value, std::string_view name) {
    return value.substr(0, value.size() - value.ends_with('"')).ends_with(name);
  };
  for (std::size_t e = 0; e < file.list.size(); ++e) {
    const FbxElement& element = file.list[e];
    if (element.name == "Model" || element.name == "AnimationCurve") object = element.value(0);
    if (element.name == "AnimationCurve") {
      found.index_of[object] = static_cast<int>(found.lists.size());
      found.lists.emplace_back();
    } else if (element.name.starts_with("Key") && found.index_of.contains(object)) {
      found.lists.back().emplace(element.name, e);
    } else if (element.name == "P" && is_named(element.value(0), "RotationOrder")) {
      found.order_of[object] = static_cast<int>(file.number(element.value(4)));
    } else if (element.name == "P" && is_named(element.value(0), "RotationPivot")) {
      for (std::size_t v = 4; v < 7; ++v) found.pivots |= file.number(element.value(v)) != 0;
    } else if (element.name == "P" && is_named(element.value(0), "UnitScaleFactor")) {
      found.metres = file.number(element.value(4)) / 100;
    } else if (element.name == "C") {
      const auto curve = found.index_of.find(element.value(1));
      const std::string_view property = element.value(3);
      if (curve == found.index_of.end() && !property.empty()) {
        found.nodes[element.value(1)].model = element.value(2);
        found.nodes[element.value(1)].property = property;
      }
      for (std::size_t axis = 0; axis < 3 && curve != found.index_of.end(); ++axis) {
        constexpr std::array kAxes = {"d|X", "d|Y", "d|Z"};
        if (!is_named(property, kAxes[axis])) continue;
        found.nodes[element.value(2)].curves[axis] = curve->second;
      }
    }
  }
  return found;
}

Curve read_curve(const FbxElements& file, const std::map<std::string_view, std::size_t>& lists,
                 double& unknown_gap) {
  const auto numbers = [&](const char* name) {
    const auto found = lists.find(name);
    return found == lists.end() ? std::vector<double>()
                                : file.numbers(file.list[found->second].value(0));
  };
  Curve curve{.times = numbers("KeyTime"), .values = numbers("KeyValueFloat"), .segments = {}};
  if (curve.times.empty() || curve.times.size() != curve.values.size()) return curve;
  for (double& time : curve.times) time /= kTicksPerSecond;
  const auto flags = numbers("KeyAttrFlags"), uses = numbers("KeyAttrRefCount");
  auto data = numbers("KeyAttrDataFloat");
  data.resize(4 * flags.size());
  std::vector<FbxKey> keys;
  for (std::size_t a = 0; a < std::min(flags.size(), uses.size()); ++a) {
    const auto left = static_cast<double>(curve.times.size() - keys.size());
    keys.insert(keys.end(), static_cast<std::size_t>(std::clamp(uses[a], 0.0, left)),
                fbx_key(flags[a], &data[4 * a], file.word == 0));
  }
  keys.resize(curve.times.size(), keys.empty() ? FbxKey() : keys.back());
  shape_segments(curve, keys, unknown_gap);
  return curve;
}

CurveSet read_curves(const FbxElements& file, const FbxCurves& found) {
  CurveSet set{.pivots = found.pivots};
  for (const auto& lists : found.lists) {
    set.curves.push_back(read_curve(file, lists, set.result.gap));
  }
  for (const auto& [id, node] : found.nodes) {
    const bool turns = node.property.find("Lcl Rotation") != std::string_view::npos;
    const bool moves = node.property.find("Lcl Translation") != std::string_view::npos;
    for (const int curve : node.curves) {
      if (moves && curve >= 0) set.curves[static_cast<std::size_t>(curve)].metres = found.metres;
    }
    if (!turns) continue;
    // In the order of the product, in which the last is applied first.
    constexpr std::array<std::array<std::size_t, 3>, 6> kProducts = {
        {{2, 1, 0}, {1, 2, 0}, {0, 2, 1}, {2, 0, 1}, {1, 0, 2}, {0, 1, 2}}};
    const auto order = found.order_of.find(node.model);
    const bool usual = order == found.order_of.end() || order->second < 0 || order->second > 5;
    std::vector<Turn>& turned = set.rotations.emplace_back();
    for (const std::size_t axis : kProducts[usual ? 0 : static_cast<std::size_t>(order->second)]) {
      turned.push_back({.axis = Vec3::Unit(static_cast<int>(axis)), .curve = node.curves[axis]});
    }
  }
  return set;
}

}  // namespace

std::optional<ResampledFile> resample_fbx(std::string_view text) {
  const auto file = fbx_elements(text);
  if (!file) return std::nullopt;
  const FbxCurves found = find_curves(*file);
  CurveSet set = read_curves(*file, found);
  resample(set);
  ResampledFile result{.text = {}, .result = set.result};
  std::map<std::size_t, std::vector<double>> lists;
  for (std::size_t c = 0; c < set.curves.size(); ++c) {
    Curve& curve = set.curves[c];
    if (!curve.changed) continue;
    for (double& time : curve.times) time = std::round(time * kTicksPerSecond);
    lists[found.lists[c].at("KeyTime")] = std::move(curve.times);
    lists[found.lists[c].at("KeyValueFloat")] = std::move(curve.values);
  }
  if (!lists.empty()) result.text = file->with(lists);
  return result;
}

}  // namespace krok::assimp
