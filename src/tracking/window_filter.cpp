#include <Eigen/Eigenvalues>
#include <algorithm>

#include "hand_filter.h"

namespace mrhi {
namespace {

/// The unit q with the greatest sum of (q.q_i)^2 = q^T (sum q_i q_i^T) q, that is the eigenvector of the
/// greatest eigenvalue, which the solver gives last. Signs of q_i drop out of the products; a mean of the
/// four numbers would need them alike.
Quaternion mean_orientation(const SampleHistory& history, int count) {
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector4d q = history.samples[i].palm.orientation.coeffs();
    sum += q * q.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(sum);
  Quaternion mean(Eigen::Vector4d(solver.eigenvectors().col(3)));
  // q and -q are one rotation: keep the newest sample's sign, so that the result does not depend on the
  // solver's.
  if (mean.dot(history.samples[0].palm.orientation) < 0.0) mean.coeffs() = -mean.coeffs();
  return mean.normalized();
}

/// Mean of a capsule from the newest sample back to the first that lacks it: a bone that was missing is not
/// averaged with its earlier positions.
Capsule mean_capsule(const SampleHistory& history, int count, std::size_t capsule) {
  Capsule sum;
  int present = 0;
  while (present < count && history.samples[present].capsules[capsule].radius > 0.0) {
    const Capsule& sample = history.samples[present].capsules[capsule];
    sum.start += sample.start;
    sum.end += sample.end;
    sum.radius += sample.radius;
    ++present;
  }
  if (present == 0) return {};
  return {sum.start / present, sum.end / present, sum.radius / present};
}

/// Samples in the sum: F, or F + 1 as printed.
int samples_in_sum(const FilterConfiguration& filter) {
  return std::min(filter.window + (filter.as_printed ? 1 : 0), kMaxFilterWindow);
}

/// As printed, Eq. 1 adds F + 1 samples and divides by F: at F = 3 the hand is 4/3 as far from the origin as
/// it should be. Widths are true means. With fewer than F + 1 samples the factor is that of F + 1.
Hand window_mean(double, const FilterConfiguration& filter, FilterMemory& memory) {
  const SampleHistory& history = memory.history;
  const int count = std::min(samples_in_sum(filter), history.size);
  Hand mean = history.samples[0];
  const double gain = filter.as_printed ? (filter.window + 1.0) / filter.window : 1.0;
  if (count == 1 && gain == 1.0) return mean;
  for (int i = 1; i < count; ++i) {
    const Hand& sample = history.samples[i];
    mean.palm.position += sample.palm.position;
    mean.wrist += sample.wrist;
    mean.palm_width += sample.palm_width;
  }
  mean.palm.position /= count;
  mean.wrist /= count;
  mean.palm_width /= count;
  mean.palm.orientation = mean_orientation(history, count);
  for (std::size_t c = 0; c < kCapsules; ++c) mean.capsules[c] = mean_capsule(history, count, c);
  if (gain == 1.0) return mean;
  for (std::size_t point = 0; point < kHandPoints; ++point) hand_point(mean, point) *= gain;
  return mean;
}

}  // namespace

/// Eq. 1 read as the mean of the last F frames, fewer at the start; the palm's orientation is the chordal
/// mean (Markley et al. 2007); a phalanx is averaged over the newest unbroken run of samples that have it.
extern const HandFilter window_filter{
    "window", 1,
    []() -> std::vector<FilterSetting> {
      return {{"window", "", {1, kMaxFilterWindow}, {1, kMaxFilterWindow}, &FilterConfiguration::window}};
    },
    samples_in_sum, window_mean};

}  // namespace mrhi
