#include "tools/krok-fit/fit_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "draw/plot.h"
#include "parametric/bounds.h"
#include "rbf/sobol.h"
#include "rbf/weight_evaluator.h"

namespace krok::cli::fit {

namespace {

using draw::Axis;
using draw::Chart;
using draw::Panel;
using draw::Scale;
using draw::Series;
using draw::SeriesStyle;

constexpr int kMaxCells = 72;      // of a weight map, in each direction
constexpr int kAllCells = 47'000;  // of all weight maps together
constexpr int kMaxSurfaces = 64;   // examples with a weight map
constexpr int kMeasuredPoints = 400;

Series series_of(std::string name, SeriesStyle style, int colour = -1, bool faint = false) {
  Series series;
  series.name = std::move(name);
  series.style = style;
  series.colour = colour;
  series.faint = faint;
  return series;
}

Axis axis_of(std::string label, std::string unit = {}, Scale scale = Scale::linear) {
  Axis axis;
  axis.label = std::move(label);
  axis.unit = std::move(unit);
  axis.scale = scale;
  return axis;
}

class Charts {
 public:
  Charts(const LibraryInput& input, const FittedLibrary& fitted)
      : input_(input),
        fitted_(fitted),
        bounds_(parametric::bounds_of(input.library)),
        dimensions_(input.lower.size()) {}

  Chart errors() const {
    Chart chart;
    chart.title = "Error at held-out points";
    const auto& rounds = fitted_.refined.rounds;
    const auto rounds_before = fitted_.start.rounds.size();
    int sum = fitted_.start.function.inserted();
    std::vector<double> inserted = {static_cast<double>(sum)};
    std::vector<const krok::fit::RefineMetrics*> charts = {
        rounds_before == 0 ? &fitted_.refined.before : &rounds[rounds_before - 1].after};
    for (std::size_t r = rounds_before; r < rounds.size(); ++r) {
      sum += rounds[r].inserted;
      inserted.push_back(sum);
      charts.push_back(&rounds[r].after);
    }
    // Shown as a drop at the end.
    if (fitted_.refined.polished) {
      inserted.push_back(sum);
      charts.push_back(&fitted_.refined.polished->after);
    }
    // A logarithmic axis has no 0, so the examples count as points.
    const auto examples = static_cast<double>(input_.library.examples.size());
    for (double& count : inserted) count += examples;
    for (std::size_t d = 0; d < dimensions_; ++d) {
      const ShownUnit unit = unit_for_errors(input_.library.parameters[d]);
      Panel panel;
      panel.title = name(d);
      panel.x = axis_of("examples and inserted points", {}, Scale::logarithmic);
      panel.y = axis_of("error", unit.name, Scale::logarithmic);
      Series largest = series_of("largest", SeriesStyle::line_and_points);
      Series most = series_of("95th percentile", SeriesStyle::line_and_points);
      Series mean = series_of("mean", SeriesStyle::line_and_points);
      for (Series* series : {&largest, &most, &mean}) series->x = inserted;
      for (const krok::fit::RefineMetrics* at : charts) {
        largest.y.push_back(at->within[d].largest * unit.factor);
        most.y.push_back(at->within[d].most * unit.factor);
        mean.y.push_back(at->within[d].mean * unit.factor);
      }
      panel.series = {std::move(largest), std::move(most), std::move(mean)};
      chart.panels.push_back(std::move(panel));
    }
    return chart;
  }

  Result<Chart> weights() const {
    const auto evaluator = rbf::WeightEvaluator::create(fitted_.refined.function);
    if (!evaluator) return evaluator.error();
    const auto count = static_cast<int>(input_.library.examples.size());
    const int shown = std::min(count, kMaxSurfaces);
    Chart chart;
    chart.title = shown == count ? "Weights of examples"
                                 : fmt::format("Weights of {} of {} examples", shown, count);
    chart.columns = std::clamp(static_cast<int>(std::ceil(std::sqrt(shown))), 3, 5);
    chart.panel_width = 300;
    chart.panel_height = dimensions_ > 1 ? 260 : 180;
    const int cells = std::min(kMaxCells, static_cast<int>(std::sqrt(kAllCells / shown)));
    for (int k = 0; k < shown; ++k) {
      // Evenly spaced in the list.
      const int example = shown < 2 ? 0 : k * (count - 1) / (shown - 1);
      chart.panels.push_back(dimensions_ > 1 ? surface(*evaluator, example, cells)
                                             : curve(*evaluator, example));
    }
    return chart;
  }

  Chart parameters() const {
    Chart chart;
    chart.title = "Examples and inserted points";
    chart.columns = 2;
    chart.panel_width = 420;
    chart.panel_height = 320;
    for (std::size_t a = 0; a < dimensions_; ++a) {
      for (std::size_t b = a + 1; b < dimensions_; ++b) chart.panels.push_back(places(a, b));
    }
    if (dimensions_ == 1) chart.panels.push_back(places(0, 0));
    return chart;
  }

  Result<Chart> measured() const {
    const auto before = rbf::WeightEvaluator::create(fitted_.start.function);
    if (!before) return before.error();
    const auto after = rbf::WeightEvaluator::create(fitted_.refined.function);
    if (!after) return after.error();
    const std::vector<double> points =
        rbf::points_inside(fitted_.refined.function, kMeasuredPoints, 7, inside());
    const std::vector<double> errors_before = errors_at(points, *before);
    const std::vector<double> errors_after = errors_at(points, *after);
    Chart chart;
    chart.title = "Measured minus requested";
    for (std::size_t d = 0; d < dimensions_; ++d) {
      const ShownUnit unit = unit_for_values(input_.library.parameters[d]);
      const ShownUnit error_unit = unit_for_errors(input_.library.parameters[d]);
      Panel panel;
      panel.title = name(d);
      panel.x = axis_of("requested", unit.name);
      panel.y = axis_of("error", error_unit.name);
      Series first = series_of("before refinement", SeriesStyle::points, 0, true);
      Series second = series_of("after", SeriesStyle::points, 1);
      for (std::size_t p = d; p < points.size(); p += dimensions_) {
        for (Series* series : {&first, &second}) series->x.push_back(points[p] * unit.factor);
        first.y.push_back(errors_before[p] * error_unit.factor);
        second.y.push_back(errors_after[p] * error_unit.factor);
      }
      panel.series = {std::move(first), std::move(second)};
      chart.panels.push_back(std::move(panel));
    }
    return chart;
  }

 private:
  const std::string& name(std::size_t d) const { return input_.description.parameters[d].name; }

  rbf::Inside inside() const {
    return [this](std::span<const double> point) {
      return parametric::outside(bounds_, point).distance <= 0;
    };
  }

  Axis axis(std::size_t d) const {
    return axis_of(name(d), unit_for_values(input_.library.parameters[d]).name);
  }
  double shown(std::size_t d, double value) const {
    return value * unit_for_values(input_.library.parameters[d]).factor;
  }

  // Interpolates within a parameter's range.
  double between(std::size_t d, double part) const {
    return input_.lower[d] + part * (input_.upper[d] - input_.lower[d]);
  }

  std::vector<double> middle() const {
    std::vector<double> point(dimensions_);
    for (std::size_t d = 0; d < dimensions_; ++d) point[d] = between(d, 0.5);
    return point;
  }

  Panel surface(const rbf::WeightEvaluator& evaluator, int example, int cells) const {
    const auto index = static_cast<std::size_t>(example);
    Panel panel;
    panel.title = input_.library.examples[index].name;
    panel.legend = false;
    panel.x = axis(0);
    panel.y = axis(1);
    draw::Field field;
    field.columns = field.rows = cells;
    field.x_low = shown(0, input_.lower[0]);
    field.x_high = shown(0, input_.upper[0]);
    field.y_low = shown(1, input_.lower[1]);
    field.y_high = shown(1, input_.upper[1]);
    std::vector<double> point = middle(), weights(input_.library.examples.size());
    const rbf::Inside is_inside = inside();
    for (int row = 0; row < cells; ++row) {
      for (int column = 0; column < cells; ++column) {
        point[0] = between(0, (column + 0.5) / cells);
        point[1] = between(1, (row + 0.5) / cells);
        evaluator.weights(point, weights);
        field.values.push_back(is_inside(point) ? weights[index]
                                                : std::numeric_limits<double>::quiet_NaN());
      }
    }
    panel.field = std::move(field);
    Series self = series_of({}, SeriesStyle::points, 6);
    self.x = {shown(0, input_.library.examples[index].parameters[0])};
    self.y = {shown(1, input_.library.examples[index].parameters[1])};
    panel.series.push_back(std::move(self));
    return panel;
  }

  Panel curve(const rbf::WeightEvaluator& evaluator, int example) const {
    const auto index = static_cast<std::size_t>(example);
    Panel panel;
    panel.title = input_.library.examples[index].name;
    panel.legend = false;
    panel.x = axis(0);
    panel.y = axis_of("weight");
    Series line;
    std::vector<double> weights(input_.library.examples.size());
    for (int k = 0; k <= 4 * kMaxCells; ++k) {
      const double value = between(0, k / (4.0 * kMaxCells));
      evaluator.weights({&value, 1}, weights);
      line.x.push_back(shown(0, value));
      line.y.push_back(weights[index]);
    }
    panel.series.push_back(std::move(line));
    return panel;
  }

  Panel places(std::size_t a, std::size_t b) const {
    const rbf::WeightFunction& function = fitted_.refined.function;
    Panel panel;
    panel.x = axis(a);
    panel.y = a == b ? axis_of("order") : axis(b);
    Series examples = series_of("examples", SeriesStyle::points, 6);
    Series inserted = series_of("inserted", SeriesStyle::points, 1);
    Series refused = series_of("refused", SeriesStyle::points, 0, true);
    const auto add = [&](Series& series, std::span<const double> point) {
      series.x.push_back(shown(a, point[a]));
      series.y.push_back(a == b ? static_cast<double>(series.x.size()) : shown(b, point[b]));
    };
    for (int k = 0; k < function.centre_count(); ++k) {
      add(k < function.examples ? examples : inserted, function.centre(k));
    }
    for (const krok::fit::RefusedPoint& point : fitted_.refined.refused) add(refused, point.point);
    panel.series = {std::move(refused), std::move(inserted), std::move(examples)};
    return panel;
  }

  // Measured minus requested, [points x d]; NaN where it cannot be measured.
  std::vector<double> errors_at(std::span<const double> points,
                                const rbf::WeightEvaluator& evaluator) const {
    const parametric::Measure measure(input_.library, fitted_.packed);
    auto scratch = measure.make_scratch();
    std::vector<double> errors(points.size()), weights(input_.library.examples.size());
    for (std::size_t p = 0; p < points.size(); p += dimensions_) {
      const auto point = points.subspan(p, dimensions_);
      const auto error = std::span(errors).subspan(p, dimensions_);
      evaluator.weights(point, weights);
      const bool done = measure(weights, error, {}, scratch).ok();
      for (std::size_t d = 0; d < dimensions_; ++d) {
        error[d] = done ? error[d] - point[d] : std::numeric_limits<double>::quiet_NaN();
      }
    }
    return errors;
  }

  const LibraryInput& input_;
  const FittedLibrary& fitted_;
  const parametric::Bounds bounds_;
  const std::size_t dimensions_;
};

}  // namespace

Result<std::vector<ChartFile>> make_charts(const LibraryInput& input, const FittedLibrary& fitted) {
  const Charts charts(input, fitted);
  const auto weights = charts.weights();
  if (!weights) return weights.error();
  const auto measured = charts.measured();
  if (!measured) return measured.error();
  std::vector<std::pair<std::string, Chart>> named;
  named.emplace_back("errors.svg", charts.errors());
  named.emplace_back("weights.svg", *weights);
  named.emplace_back("parameters.svg", charts.parameters());
  named.emplace_back("measured.svg", *measured);
  std::vector<ChartFile> files;
  for (const auto& [name, chart] : named) {
    auto svg = draw::to_svg(chart);
    if (!svg) return svg.error();
    files.emplace_back(name, *std::move(svg));
  }
  return files;
}

}  // namespace krok::cli::fit
