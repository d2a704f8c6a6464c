#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "formats/path/path_data_internal.h"

namespace krok::path_file {

namespace {

constexpr double kPieceLength = 0.02;  // metres
constexpr double kMaxPieces = 20000;   // of a curve

class DataReader {
 public:
  DataReader(std::string_view data, const Affine2& to_metres, std::vector<Vec2>& points)
      : in_(data), to_metres_(to_metres), points_(points) {}

  std::optional<DataFault> read() {
    while (!in_.at_end()) {
      const std::size_t at = in_.offset();
      const char letter = in_.take();
      if (std::string_view("MmLlHhVvCcSsQqTtAaZz").find(letter) == std::string_view::npos) {
        return DataFault{at, fmt::format("'{}' is no command of path data", shown({&letter, 1}))};
      }
      if (!begun_ && letter != 'M' && letter != 'm') {
        return DataFault{at, "path data must begin with M or m"};
      }
      if (begun_ && (letter == 'M' || letter == 'm')) {
        return DataFault{at, "the path has a second part; a way has one"};
      }
      if (closed_) return DataFault{at, "something follows the path's end (Z)"};
      if (auto fault = command(letter)) return fault;
    }
    if (!begun_) return DataFault{0, "the path is empty"};
    return {};
  }

 private:
  std::optional<DataFault> command(char letter) {
    command_ = ascii_lower(letter);
    relative_ = letter == command_;
    if (command_ == 'z') {
      closed_ = true;
      line_to(begin_);
      return {};
    }
    bool first = true;
    while (true) {
      in_.skip_space();
      if (!first) in_.skip_comma();
      const std::size_t at = in_.offset();
      if (!first && !starts_number(in_.peek())) return {};
      if (auto fault = segment()) return fault;
      if (in_.offset() == at) return DataFault{at, "a number is missing"};
      if (points_.size() > kMaxPoints) {
        return DataFault{at, fmt::format("the way has more than {} points", kMaxPoints),
                         "path-limit"};
      }
      // Further pairs of a move are lines.
      if (command_ == 'm') command_ = 'l';
      first = false;
    }
  }

  static bool starts_number(char c) {
    return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.';
  }

  // Reads `count` numbers; a fault if there are fewer.
  std::optional<DataFault> numbers(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      if (i > 0) in_.skip_comma();
      const auto value = in_.number();
      if (!value) {
        return DataFault{in_.offset(), fmt::format("'{}' needs {} numbers", command_, count)};
      }
      values_[i] = *value;
    }
    return {};
  }

  // A point from two of the numbers read.
  Vec2 point(std::size_t first) const {
    const Vec2 value(values_[first], values_[first + 1]);
    return relative_ ? Vec2(here_ + value) : value;
  }

  std::optional<DataFault> segment() {
    // The control points that S and T mirror count only straight after a curve of their kind.
    const Vec2 cubic_mirror = last_cubic_ ? Vec2(2 * here_ - control_) : here_;
    const Vec2 quadratic_mirror = last_quadratic_ ? Vec2(2 * here_ - control_) : here_;
    last_cubic_ = last_quadratic_ = false;
    switch (command_) {
      case 'm':
        if (auto fault = numbers(2)) return fault;
        here_ = begin_ = point(0);
        begun_ = true;
        add(here_);
        return {};
      case 'l':
        if (auto fault = numbers(2)) return fault;
        line_to(point(0));
        return {};
      case 'h':
        if (auto fault = numbers(1)) return fault;
        line_to({values_[0] + (relative_ ? here_.x() : 0), here_.y()});
        return {};
      case 'v':
        if (auto fault = numbers(1)) return fault;
        line_to({here_.x(), values_[0] + (relative_ ? here_.y() : 0)});
        return {};
      case 'c':
        if (auto fault = numbers(6)) return fault;
        cubic_to(point(0), point(2), point(4));
        return {};
      case 's':
        if (auto fault = numbers(4)) return fault;
        cubic_to(cubic_mirror, point(0), point(2));
        return {};
      case 'q':
        if (auto fault = numbers(4)) return fault;
        quadratic_to(point(0), point(2));
        return {};
      case 't':
        if (auto fault = numbers(2)) return fault;
        quadratic_to(quadratic_mirror, point(0));
        return {};
      default:
        return arc();
    }
  }

  std::optional<DataFault> arc() {
    if (auto fault = numbers(3)) return fault;
    const Vec2 radii(std::abs(values_[0]), std::abs(values_[1]));
    const double tilt = values_[2] * kRadiansPerDegree;
    std::array<bool, 2> flags{};
    for (bool& flag : flags) {
      in_.skip_comma();
      const auto value = in_.flag();
      if (!value) return DataFault{in_.offset(), "an arc's flag must be 0 or 1"};
      flag = *value;
    }
    in_.skip_comma();
    if (auto fault = numbers(2)) return fault;
    arc_to(radii, tilt, flags[0], flags[1], point(0));
    return {};
  }

  void add(const Vec2& place) { points_.push_back(to_metres_ * place); }

  void line_to(const Vec2& end) {
    add(end);
    here_ = end;
  }

  // How many pieces a curve needs whose length is at most that of this polyline, in file units.
  int pieces(std::initializer_list<Vec2> polyline) const {
    double length = 0;
    for (const Vec2* p = polyline.begin(); p + 1 < polyline.end(); ++p) {
      length += (to_metres_.linear() * (p[1] - p[0])).norm();
    }
    return static_cast<int>(std::clamp(std::ceil(length / kPieceLength), 1.0, kMaxPieces));
  }

  void cubic_to(const Vec2& a, const Vec2& b, const Vec2& end) {
    const Vec2 begin = here_;
    const int count = pieces({begin, a, b, end});
    for (int i = 1; i < count; ++i) {
      const double t = static_cast<double>(i) / count, u = 1 - t;
      add(u * u * u * begin + 3 * u * u * t * a + 3 * u * t * t * b + t * t * t * end);
    }
    line_to(end);
    control_ = b;
    last_cubic_ = true;
  }

  void quadratic_to(const Vec2& control, const Vec2& end) {
    const Vec2 begin = here_;
    const int count = pieces({begin, control, end});
    for (int i = 1; i < count; ++i) {
      const double t = static_cast<double>(i) / count, u = 1 - t;
      add(u * u * begin + 2 * u * t * control + t * t * end);
    }
    line_to(end);
    control_ = control;
    last_quadratic_ = true;
  }

  // From the arc's end points to its centre: SVG 2, section B.2.4.
  void arc_to(Vec2 radii, double tilt, bool large, bool sweep, const Vec2& end) {
    const Eigen::Rotation2Dd turn(tilt);
    const Vec2 half = turn.inverse() * Vec2(0.5 * (here_ - end));
    if (!(radii.minCoeff() > 0) || half.squaredNorm() == 0) return line_to(end);
    const double needed = std::sqrt((half.array() / radii.array()).square().sum());
    if (needed > 1) radii *= needed;
    const Vec2 unit = half.array() / radii.array();
    const double square = unit.squaredNorm();
    const double factor =
        (large == sweep ? -1 : 1) * std::sqrt(std::max(0.0, (1 - square) / square));
    const Vec2 unit_centre = factor * Vec2(unit.y(), -unit.x());
    const Vec2 centre = turn * Vec2(radii.array() * unit_centre.array()) + 0.5 * (here_ + end);
    const Vec2 from = unit - unit_centre, to = -unit - unit_centre;
    const double begin_angle = std::atan2(from.y(), from.x());
    double swept = std::atan2(to.y(), to.x()) - begin_angle;
    if (sweep && swept < 0) swept += 2 * kPi;
    if (!sweep && swept > 0) swept -= 2 * kPi;
    const double radius = radii.maxCoeff();
    const int count = std::max(pieces({Vec2::Zero(), Vec2(std::abs(swept) * radius, 0)}),
                               static_cast<int>(std::ceil(std::abs(swept) / 0.1)));
    for (int i = 1; i < count; ++i) {
      const double angle = begin_angle + swept * i / count;
      const Vec2 on_ellipse(radii.x() * std::cos(angle), radii.y() * std::sin(angle));
      add(centre + turn * on_ellipse);
    }
    line_to(end);
  }

  NumberScanner in_;
  const Affine2& to_metres_;
  std::vector<Vec2>& points_;
  char command_ = 'm';
  bool relative_ = false, begun_ = false, closed_ = false;
  bool last_cubic_ = false, last_quadratic_ = false;
  std::array<double, 6> values_{};
  Vec2 here_ = Vec2::Zero(), begin_ = Vec2::Zero(), control_ = Vec2::Zero();
};

}  // namespace

std::optional<DataFault> read_path_data(std::string_view data, const Affine2& to_metres,
                                        std::vector<Vec2>& points) {
  return DataReader(data, to_metres, points).read();
}

std::optional<DataFault> read_polyline(std::string_view data, const Affine2& to_metres,
                                       std::vector<Vec2>& points) {
  NumberScanner in(data);
  while (!in.at_end()) {
    const auto x = in.number();
    in.skip_comma();
    const auto y = in.number();
    if (!x || !y) return DataFault{in.offset(), "a polyline needs pairs of numbers"};
    points.push_back(to_metres * Vec2(*x, *y));
    in.skip_comma();
  }
  return {};
}

}  // namespace krok::path_file
