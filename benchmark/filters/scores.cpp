#include "scores.h"

#include <algorithm>
#include <cmath>

#include "tracking/hand_filter.h"

namespace mrhi::filter_benchmark {
namespace {

constexpr double kJitterWidth = 0.07;                               // removes frequencies below 10 Hz [s]
constexpr double kShortestMove = 0.1;                               // [s]
constexpr double kEarliest = -0.03, kLatest = 0.1, kShift = 0.001;  // range and step of the tested shifts [s]

class MeanSquare {
 public:
  void add(double square) {
    sum_ += square;
    ++count_;
  }
  double root() const { return count_ > 0 ? std::sqrt(sum_ / count_) : 0.0; }

 private:
  double sum_ = 0.0;
  int count_ = 0;
};

struct Sums {
  MeanSquare jitter, moving_jitter, still_error, moving_error, bone_error;
  std::vector<double> lags;
};

using Points = Eigen::Matrix<double, Eigen::Dynamic, 3>;

Points points_of(const Paths& paths, std::size_t joint) {
  return paths.middleCols<3>(static_cast<Eigen::Index>(3 * joint));
}

Vector3 at(const std::vector<double>& times, const Points& points, double time) {
  const auto after = std::lower_bound(times.begin(), times.end(), time);
  if (after == times.begin()) return points.row(0);
  if (after == times.end()) return points.bottomRows<1>().transpose();
  const auto i = static_cast<Eigen::Index>(after - times.begin());
  const double from = *(after - 1), share = (time - from) / (*after - from);
  return ((1.0 - share) * points.row(i - 1) + share * points.row(i)).transpose();
}

/// Shift that best aligns frames `first` to before `last` of a path with the reference.
double lag_of(const std::vector<double>& times, const Points& path, const Points& reference,
              std::size_t first, std::size_t last) {
  std::vector<double> errors;
  for (double shift = kEarliest; shift <= kLatest; shift += kShift) {
    double error = 0.0;
    for (std::size_t i = first; i < last; ++i)
      error += (path.row(static_cast<Eigen::Index>(i)).transpose() - at(times, reference, times[i] - shift))
                   .squaredNorm();
    errors.push_back(error);
  }
  const auto least =
      static_cast<std::size_t>(std::min_element(errors.begin(), errors.end()) - errors.begin());
  double place = static_cast<double>(least);
  if (least > 0 && least + 1 < errors.size()) {
    const double before = errors[least - 1], after = errors[least + 1];
    place += 0.5 * (before - after) / (before - 2.0 * errors[least] + after);
  }
  return kEarliest + kShift * place;
}

void add_lags(const Take& take, std::size_t joint, const Points& path, std::vector<double>& lags) {
  const Points reference = points_of(take.reference, joint);
  const std::vector<Doing>& doing = take.doing[joint];
  for (std::size_t first = 0; first < doing.size(); ++first) {
    if (doing[first] != Doing::moving) continue;
    std::size_t last = first;
    while (last < doing.size() && doing[last] == Doing::moving) ++last;
    if (take.times[last - 1] - take.times[first] >= kShortestMove)
      lags.push_back(lag_of(take.times, path, reference, first, last));
    first = last;
  }
}

void add_take(const Take& take, const FilterConfiguration& filter, Sums& sums) {
  FilterMemory memory;
  std::vector<Hand> hands;
  for (std::size_t i = 0; i < take.input.size(); ++i) {
    const double elapsed = i > 0 ? take.times[i] - take.times[i - 1] : 0.0;
    hands.push_back(filtered(take.input[i], elapsed, filter, memory));
  }
  const Paths paths = paths_of(hands, take.joints);
  const Paths fast = paths - smoothed(take.times, paths, kJitterWidth).positions;
  const Paths error = paths - take.reference;
  for (std::size_t joint = 0; joint < take.joints.capsules.size(); ++joint) {
    for (std::size_t frame = 0; frame < take.times.size(); ++frame) {
      const auto row = static_cast<Eigen::Index>(frame), column = static_cast<Eigen::Index>(3 * joint);
      const Doing doing = take.doing[joint][frame];
      if (doing == Doing::neither) continue;
      const bool still = doing == Doing::still;
      (still ? sums.jitter : sums.moving_jitter).add(fast.block<1, 3>(row, column).squaredNorm());
      (still ? sums.still_error : sums.moving_error).add(error.block<1, 3>(row, column).squaredNorm());
    }
  }
  for (const auto& [from, to] : take.joints.bones) {
    const auto lengths = [&, f = from, t = to](const Paths& of) -> Eigen::VectorXd {
      return (points_of(of, t) - points_of(of, f)).rowwise().norm();
    };
    const Eigen::VectorXd changes = lengths(paths) - lengths(take.reference);
    for (const double change : changes) sums.bone_error.add(change * change);
  }
  for (const std::size_t tip : take.joints.tips) add_lags(take, tip, points_of(paths, tip), sums.lags);
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

}  // namespace

Scores score(const std::vector<Take>& takes, const FilterConfiguration& filter) {
  Sums sums;
  for (const Take& take : takes) add_take(take, filter, sums);
  return {sums.jitter.root(),       sums.moving_jitter.root(), quantile(sums.lags, 0.5),
          quantile(sums.lags, 0.9), sums.still_error.root(),   sums.moving_error.root(),
          sums.bone_error.root(),   sums.lags.size()};
}

}  // namespace mrhi::filter_benchmark
