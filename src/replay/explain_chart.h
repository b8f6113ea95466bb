#pragma once

#include <string>
#include <utility>
#include <vector>

#include "explain.h"

namespace mrhi {

// Charts of a page, as SVG.

std::string escaped(const std::string& text);  ///< for HTML
std::string short_number(double value);        ///< three digits
std::string text_at(double x, double y, const std::string& text, const char* anchor = "start");
std::string svg(double width, double height, const std::string& inside, const char* kind = "chart");

/// What all charts of one thing share.
struct TimeAxis {
  struct Mark {
    double time;
    std::string color, name;
  };
  struct Shade {
    double from, until;
    std::string name;
  };

  double from = 0.0, until = 1.0;  ///< [s]
  std::vector<Mark> marks;         ///< a line across
  std::vector<Shade> shades;       ///< behind everything

  double x(double time) const;
};

constexpr double kChartWidth = 940.0;

struct Curve {
  std::string color;
  std::vector<std::pair<double, double>> points;  ///< [s], value
};

struct Chart {
  std::string title;
  std::vector<Curve> curves;
  double least_top = 1.0;     ///< the axis goes up to that at least
  double most_top = 1e30;     ///< what is above is cut off
  std::vector<double> lines;  ///< across, dashed
};
std::string drawn(const Chart& chart, const TimeAxis& axis);

/// A row with coloured stretches of time.
struct Stretch {
  double from, until;
  std::string color, name, label;  ///< the label is shown where there is room
};
struct Strip {
  std::string name;
  std::vector<Stretch> stretches;
};
std::string drawn(const std::string& title, const std::vector<Strip>& strips, const TimeAxis& axis);

const char* finger_color(int finger);  ///< thumb to palm; Okabe & Ito's

/// Hand and object by lines, from two sides, shortly before a loss and at it.
std::string drawings_of(const Explanation& story, const Loss& loss);

}  // namespace mrhi
