#include "explain_chart.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace mrhi {
namespace {

constexpr double kLeft = 52.0, kRight = 8.0, kTop = 20.0, kPlot = 84.0, kBottom = 16.0, kRow = 17.0;
constexpr double kBreak = 0.1;   // a curve with a longer gap is two [s]
constexpr double kLetter = 6.2;  // width [px]

std::string fixed(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.1f", std::isfinite(value) ? value : 0.0);
  return text;
}

std::string line(double x1, double y1, double x2, double y2, const std::string& style) {
  return "<line x1='" + fixed(x1) + "' y1='" + fixed(y1) + "' x2='" + fixed(x2) + "' y2='" + fixed(y2) +
         "' " + style + "/>";
}

std::string box(double x, double y, double width, double height, const std::string& color,
                const std::string& name) {
  return "<rect x='" + fixed(x) + "' y='" + fixed(y) + "' width='" + fixed(std::max(width, 0.6)) +
         "' height='" + fixed(height) + "' fill='" + color + "'><title>" + escaped(name) + "</title></rect>";
}

/// 1, 2 or 5 times a power of ten, so that about `count` of them fill the range.
double round_step(double range, double count) {
  const double raw = std::max(range, 1e-9) / count, power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (raw <= factor * power) return factor * power;
  return 10.0 * power;
}

/// Multiples of a round step within the range.
std::vector<double> ticks(double from, double until, double count) {
  std::vector<double> all;
  const double step = round_step(until - from, count);
  for (double i = std::ceil(from / step - 1e-9); i * step <= until + 1e-9 * step; ++i)
    all.push_back(std::abs(i) < 1e-9 ? 0.0 : i * step);
  return all;
}

std::string background(const TimeAxis& axis, double top, double height) {
  std::string inside;
  for (const TimeAxis::Shade& shade : axis.shades) {
    const double from = std::max(shade.from, axis.from), until = std::min(shade.until, axis.until);
    if (until > from)
      inside += box(axis.x(from), top, axis.x(until) - axis.x(from), height, "#eee3f5", shade.name);
  }
  for (const double time : ticks(axis.from, axis.until, 8.0)) {
    inside += line(axis.x(time), top, axis.x(time), top + height, "stroke='#ededed'");
    inside += text_at(axis.x(time), top + height + 12, short_number(time) + " s", "middle");
  }
  return inside;
}

std::string marks(const TimeAxis& axis, double top, double height) {
  std::string inside;
  for (const TimeAxis::Mark& mark : axis.marks) {
    if (mark.time < axis.from || mark.time > axis.until) continue;
    inside += "<g>" +
              line(axis.x(mark.time), top, axis.x(mark.time), top + height,
                   "stroke='" + mark.color + "' stroke-width='1.5' stroke-dasharray='4 2'") +
              "<title>" + escaped(mark.name) + "</title></g>";
  }
  return inside;
}

struct Scale {
  double low, high;
  double y(double value) const {
    return kTop + kPlot * (1.0 - (std::clamp(value, low, high) - low) / std::max(high - low, 1e-12));
  }
};

Scale scale_of(const Chart& chart, const TimeAxis& axis) {
  Scale scale{0.0, chart.least_top};
  for (const Curve& curve : chart.curves)
    for (const auto& [time, value] : curve.points) {
      if (time < axis.from || time > axis.until || !std::isfinite(value)) continue;
      scale.low = std::min(scale.low, value);
      scale.high = std::max(scale.high, value);
    }
  scale.high = std::min(scale.high, chart.most_top);
  const double step = round_step(scale.high - scale.low, 3.0);
  return {step * std::floor(scale.low / step + 1e-9), step * std::ceil(scale.high / step - 1e-9)};
}

std::string polylines(const Curve& curve, const TimeAxis& axis, const Scale& scale) {
  std::string lines, points;
  double before = -1e9;
  const auto end_line = [&] {
    if (!points.empty())
      lines += "<polyline fill='none' stroke-width='1.5' stroke-linejoin='round' stroke='" + curve.color +
               "' points='" + points + "'/>";
    points.clear();
  };
  for (const auto& [time, value] : curve.points) {
    if (time < axis.from || time > axis.until || !std::isfinite(value)) continue;
    if (time - before > kBreak) end_line();
    before = time;
    points += fixed(axis.x(time)) + "," + fixed(scale.y(value)) + " ";
  }
  end_line();
  return lines;
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '&':
        result += "&amp;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string short_number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string text_at(double x, double y, const std::string& text, const char* anchor) {
  return "<text x='" + fixed(x) + "' y='" + fixed(y) + "' text-anchor='" + anchor + "'>" + escaped(text) +
         "</text>";
}

std::string svg(double width, double height, const std::string& inside, const char* kind) {
  return "<svg class='" + std::string(kind) + "' viewBox='0 0 " + fixed(width) + " " + fixed(height) +
         "' width='" + fixed(width) + "'>" + inside + "</svg>\n";
}

double TimeAxis::x(double time) const {
  return kLeft + (kChartWidth - kLeft - kRight) * (time - from) / std::max(until - from, 1e-9);
}

std::string drawn(const Chart& chart, const TimeAxis& axis) {
  const Scale scale = scale_of(chart, axis);
  std::string inside = background(axis, kTop, kPlot);
  for (const double value : ticks(scale.low, scale.high, 3.0)) {
    inside += line(kLeft, scale.y(value), kChartWidth - kRight, scale.y(value),
                   value == 0.0 ? "stroke='#999'" : "stroke='#ededed'");
    inside += text_at(kLeft - 5, scale.y(value) + 4, short_number(value), "end");
  }
  for (const double value : chart.lines)
    if (value >= scale.low && value <= scale.high)
      inside += line(kLeft, scale.y(value), kChartWidth - kRight, scale.y(value),
                     "stroke='#777' stroke-dasharray='2 3'");
  inside += marks(axis, kTop, kPlot);
  for (const Curve& curve : chart.curves) inside += polylines(curve, axis, scale);
  inside += "<g class='title'>" + text_at(kLeft, 13, chart.title) + "</g>";
  return svg(kChartWidth, kTop + kPlot + kBottom, inside);
}

std::string drawn(const std::string& title, const std::vector<Strip>& strips, const TimeAxis& axis) {
  const double height = kRow * static_cast<double>(strips.size());
  std::string inside = background(axis, kTop, height);
  double y = kTop;
  for (const Strip& strip : strips) {
    inside += text_at(kLeft - 5, y + 12, strip.name, "end");
    for (const Stretch& stretch : strip.stretches) {
      const double from = std::max(stretch.from, axis.from), until = std::min(stretch.until, axis.until);
      if (until < from) continue;
      const double width = axis.x(until) - axis.x(from);
      inside += box(axis.x(from), y + 1, width, kRow - 2, stretch.color, stretch.name);
      if (width > kLetter * static_cast<double>(stretch.label.size()) + 6)
        inside += text_at(axis.x(from) + 4, y + 12, stretch.label);
    }
    y += kRow;
  }
  inside += marks(axis, kTop, height) + "<g class='title'>" + text_at(kLeft, 13, title) + "</g>";
  return svg(kChartWidth, kTop + height + kBottom, inside);
}

}  // namespace mrhi
