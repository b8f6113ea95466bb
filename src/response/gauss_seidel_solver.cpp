#include "gauss_seidel_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mrhi {
namespace {

/// Number of contacts that all sweeps of a step relax together, and limits of the number of sweeps. At least
/// as many sweeps as a cube of such bodies is high, and as a slender stack is: with fewer, blocks of 384 to
/// 1000 cubes without a warm start fell apart, and so did 50 boards on each other.
constexpr int kRelaxationBudget = 400, kMinSweeps = 4, kMaxSweeps = 30;
/// An island is nearly at rest if no body begins the step faster than after a fall of so many steps. It takes
/// as many sweeps as it needs, up to a larger budget, or so many times the square of the height, over which
/// loads spread. With fewer, a tower of 15 cubes gained energy and fell; more took a heap 30 times its mean
/// step and changed nothing.
constexpr double kRestFallSteps = 1.0;
constexpr int kRestBudget = 1000, kSweepsByHeight = 4;
/// The largest budget and the sweeps that it allows at least. It limits large islands at rest, and an island
/// in which a body touches another of so many times its mass has all of it: with less, a body on one of a
/// hundredth of its mass fell.
constexpr int kLargestBudget = 40000, kMinLargest = 80;
constexpr double kMassRatio = 10.0;
/// Iteration ends when a sweep changes velocities by less than this ratio of the contacts' total change. At
/// 1e-4 a box that landed slid aside by 0.5 mm, and what rests would creep.
constexpr double kConverged = 1e-6;
/// Largest distance of a contact point from the body's centre, over the bounding radius; includes the margin.
constexpr double kRadiusMargin = 1.2;
constexpr double kMaxSpeed = 1e300;  // [m/s]

/// True if two contacts belong to one pair of shapes and share a normal.
bool same_patch(const BodyContact& x, const BodyContact& y) {
  return x.key.order() >> 8 == y.key.order() >> 8 && x.normal == y.normal;
}

Vector3 velocity_at(const Motion6& motion, const Vector3& arm) {
  return motion.head<3>() + motion.tail<3>().cross(arm);
}

}  // namespace

// Free velocities are u* = (p / m + h g, I^-1 L). Impulses change them at once: unlike in IslandProblem, the
// unknowns are the contacts' impulses, and the velocities u* + M^-1 J' p are updated with each of them.
// Fixtures and hands share the last body, whose 1/m and I^-1 are 0.
void GaussSeidelSolver::begin(const ContactStep& step, const Island& island,
                              const std::vector<Vector3>& last_forces) {
  step_ = step.step;
  island_ = &island;
  last_forces_ = &last_forces;
  bodies_.clear();
  free_.clear();
  points_.clear();
  patches_.clear();
  linked_.clear();
  open_.clear();
  max_arm_ = 0.0;
  for (const IslandBody& body : island.bodies)
    add_body(step.scene.bodies[body.body], step.bodies[body.body], step);
  bodies_.push_back({Motion6::Zero(), 0.0, Matrix3::Zero()});
  make_hand_rows(step, island, hand_rows_);
  points_.reserve(hand_rows_.size() + island.links.size());
  const SpringContact* row = hand_rows_.data();
  for (const IslandBody& body : island.bodies) {
    for (std::size_t i = body.first; i < body.last; ++i) {
      if (!step.contacts[i].ignored) add_patch(row++, 1, &last_forces[step.body_contacts.size() + i]);
    }
  }
  const Vector3 none = Vector3::Zero();
  while (row < hand_rows_.data() + hand_rows_.size()) add_patch(row++, 1, &none);  // grips
  add_links(step, island);
}

void GaussSeidelSolver::add_body(const Body& body, const BodyState& state, const ContactStep& step) {
  const Matrix3 inverse_inertia = world_inverse_inertia(body, state.pose.orientation);
  free_.emplace_back();
  free_.back() << state.linear_momentum / body.mass + step_ * step.gravity,
      inverse_inertia * state.angular_momentum;
  bodies_.push_back({free_.back(), 1.0 / body.mass, inverse_inertia});
  max_arm_ = std::max(max_arm_, kRadiusMargin * body.bounding_radius);
}

/// Adds the pairs of shapes that had a force in the last step, or that close fast enough for one. Contacts
/// are sorted, so those of a pair are adjacent.
void GaussSeidelSolver::add_links(const ContactStep& step, const Island& island) {
  for (const IslandContact* link = island.links.begin(); link != island.links.end();) {
    const BodyContact& first = step.body_contacts[link->index];
    Range range{link->index, link->index};
    bool acted = false;
    for (; link != island.links.end() && same_patch(step.body_contacts[link->index], first); ++link)
      acted = (*last_forces_)[range.last++] != Vector3::Zero() || acted;
    if (step.body_contacts[range.first].share <= 0.0) continue;  // strip too narrow for springs
    if (acted) {
      add_link(step, range);
    } else {
      open_.push_back(range);
    }
  }
  checked_.clear();
  min_missing_speed_ = -kMaxSpeed;
  admit_closing(step, max_change(free_));
}

void GaussSeidelSolver::add_link(const ContactStep& step, const Range& range) {
  link_rows_.resize(range.last - range.first);
  for (std::size_t index = range.first; index < range.last; ++index) {
    make_link_row(step, *island_, step.body_contacts[index], link_rows_[index - range.first]);
    linked_.push_back(index);
  }
  add_patch(link_rows_.data(), static_cast<int>(link_rows_.size()), &(*last_forces_)[range.first]);
}

/// Adds the patch of the rows, with the last step's forces as warm start.
void GaussSeidelSolver::add_patch(const SpringContact* rows, int count, const Vector3* forces) {
  patches_.push_back(make_patch(step_, rows, count, bodies_, points_));
  const ContactPatch& patch = patches_.back();
  for (int i = 0; i < count; ++i)
    patch.start_from(forces[i], rows[i].spring, step_, points_[patch.first + i], body(patch.a),
                     body(patch.b));
}

/// Returns the closing speed that the surfaces lack for a force [m/s].
///
///     missing = n.(c_a' - c_b') - d / e,      e the time that the spring looks ahead
///
/// A force needs d+ = d - e n.u > 0. e differs between the two signs of d (look_ahead()).
double GaussSeidelSolver::missing_speed(const ContactStep& step, const Range& range) const {
  double min_speed = kMaxSpeed;
  for (std::size_t i = range.first; i < range.last; ++i) {
    const BodyContact& contact = step.body_contacts[i];
    const Motion6& b = body(island_->number_of(contact.key.b)).motion;
    const int number = island_->number_of(contact.key.a);
    const Motion6& a = number < 0 ? bodies_.back().motion : body(number).motion;
    const Vector3 velocity = velocity_at(a, contact.arm_a) - velocity_at(b, contact.arm_b);
    const double ahead = look_ahead(step_, step.configuration.damping, contact.depth > 0.0);
    min_speed = std::min(min_speed, contact.normal.dot(velocity) - contact.depth / ahead);
  }
  return min_speed;
}

/// Upper bound of the increase in closing speed since open contacts were checked [m/s]. A point at the arm r
/// changes its velocity by |dv + dw x r| <= |dv| + |r| |dw|, and a pair of bodies by at most twice the
/// largest of these. No open contact has a force while this is below the smallest missing speed found then.
double GaussSeidelSolver::max_speed_gain() const {
  double largest = 0.0;
  for (std::size_t i = 0; i < checked_.size(); ++i) {
    const Motion6 change = bodies_[i].motion - checked_[i];
    largest = std::max(largest, change.head<3>().norm() + max_arm_ * change.tail<3>().norm());
  }
  return 2.0 * largest;
}

/// Adds open contacts that now have a force; returns true if there are any. They stay for the rest of the
/// step: one without a force costs little. `given`: largest change of a body's velocity by contacts. Those
/// whose surfaces close more slowly than convergence is judged stay open: in a block of 1000 cubes without
/// gaps, some of 8000 did so in each sweep.
bool GaussSeidelSolver::admit_closing(const ContactStep& step, double given) {
  const double negligible = kConverged * given;
  if (open_.empty() || max_speed_gain() < min_missing_speed_ + negligible) return false;
  checked_.clear();
  for (const PatchBody& body : bodies_) checked_.push_back(body.motion);
  min_missing_speed_ = kMaxSpeed;
  const std::size_t before = points_.size();
  const auto kept = std::remove_if(open_.begin(), open_.end(), [&](const Range& range) {
    const double missing_speeds = missing_speed(step, range);
    if (missing_speeds < -negligible) {
      add_link(step, range);
      return true;
    }
    min_missing_speed_ = std::min(min_missing_speed_, missing_speeds);
    return false;
  });
  open_.erase(kept, open_.end());
  impulses_before_.resize(points_.size(), PatchImpulses::Zero());
  impulse_directions_.resize(points_.size(), PatchImpulses::Zero());
  return points_.size() > before;
}

[[gnu::always_inline]] inline void GaussSeidelSolver::relax(ContactPatch& patch) {
  PatchBody &a = body(patch.a), &b = body(patch.b);
  Motion6 motion = patch.relative_motion(a, b), impulse = Motion6::Zero();
  patch.relax(step_, &points_[patch.first], patch.twists ? &hand_rows_[patch.first].spring : nullptr, motion,
              impulse);
  if (impulse != Motion6::Zero()) patch.apply(impulse, a, b);
}

bool GaussSeidelSolver::acts() const {
  return std::any_of(points_.begin(), points_.end(), [](const PatchPoint& point) {
    return point.impulses[kNormal] > 0.0 || point.bond > 0.0;
  });
}

// Symmetric sweep: a stack's load spreads through it in either direction within one sweep. Sweeps in one
// direction only would spread it by one body a sweep in the other. Conjugate directions also need a symmetric
// sweep (SSOR).
void GaussSeidelSolver::sweep() {
  for (std::size_t i = 0; i < bodies_.size(); ++i) motions_before_[i] = bodies_[i].motion;
  for (std::size_t i = 0; i < points_.size(); ++i) impulses_before_[i] = points_[i].impulses;
  for (ContactPatch& patch : patches_) relax(patch);
  for (std::size_t i = patches_.size(); i-- > 0;) relax(patches_[i]);
}

/// Extrapolates along the previous search direction, made conjugate by Fletcher and Reeves' rule. The factor
/// is the ratio of the squared changes of two sweeps, or 0 if they have grown. `last` is the squared change
/// of the previous sweep; returns that of this one.
///
///     d_k = x_sweep - x_before,     beta = |d_k|^2 / |d_k-1|^2 < 1, else 0,      s_k = d_k + beta s_k-1
///     x <- x_sweep + beta s_k-1
///
/// This holds for all impulses, and for velocities, which depend on them linearly. It precedes a sweep and
/// never follows the last: extrapolated normal impulses may pull, and friction may leave its disc, until
/// contacts are relaxed.
double GaussSeidelSolver::accelerate(double last) {
  double square = 0.0;
  for (std::size_t i = 0; i < points_.size(); ++i)
    square += (points_[i].impulses - impulses_before_[i]).head<3>().squaredNorm();
  const double ratio = last > 0.0 && square < last ? square / last : 0.0;
  const auto extrapolate = [ratio](auto& now, const auto& before, auto& direction) {
    direction = (ratio * direction).eval();
    now += direction;
    direction += now - direction - before;
  };
  for (std::size_t i = 0; i < points_.size(); ++i)
    extrapolate(points_[i].impulses, impulses_before_[i], impulse_directions_[i]);
  for (std::size_t i = 0; i < free_.size(); ++i)
    extrapolate(bodies_[i].motion, motions_before_[i], motion_directions_[i]);
  return square;
}

double GaussSeidelSolver::max_mass_ratio() const {
  const auto [heaviest, lightest] = std::minmax_element(
      bodies_.begin(), bodies_.end() - 1,
      [](const PatchBody& x, const PatchBody& y) { return x.inverse_mass < y.inverse_mass; });
  return lightest->inverse_mass / heaviest->inverse_mass;
}

/// Bodies above each other in the longest stack: the largest number of contacts between a body and the
/// nearest fixture or hand. 0 without any.
int GaussSeidelSolver::height() {
  constexpr int kUnsupported = std::numeric_limits<int>::max() - 1;
  levels_.assign(bodies_.size(), kUnsupported);
  levels_.back() = 0;
  for (bool changed = true; changed;) {
    changed = false;
    const auto lift = [&](int& upper, int lower) {
      if (upper > lower + 1) upper = lower + 1, changed = true;
    };
    for (const ContactPatch& patch : patches_)
      lift(levels_[patch.b], levels_[patch.a]), lift(levels_[patch.a], levels_[patch.b]);
  }
  int highest = 0;
  for (const int level : levels_)
    if (level < kUnsupported) highest = std::max(highest, level);
  return highest;
}

int GaussSeidelSolver::max_sweeps(int height, bool rests, bool uneven) const {
  const int points = std::max(1, static_cast<int>(points_.size())), bodies = static_cast<int>(free_.size());
  int sweeps = std::max(kMinSweeps, height * height / bodies);
  while (sweeps * sweeps * sweeps < bodies) ++sweeps;
  sweeps = std::clamp(kRelaxationBudget / points, sweeps, std::max(sweeps, kMaxSweeps));
  const int most = std::max(kLargestBudget / points, kMinLargest);
  if (uneven) return std::max(sweeps, most);
  const int at_rest = std::max(kRestBudget / points, kSweepsByHeight * height * height);
  return rests ? std::max(sweeps, std::min(at_rest, most)) : sweeps;
}

/// Largest speed of a body before the step [m/s].
double GaussSeidelSolver::begin_speed(const ContactStep& step) const {
  double largest = 0.0;
  for (const Motion6& free : free_)
    largest = std::max(largest, (free.head<3>() - step_ * step.gravity).squaredNorm());
  return std::sqrt(largest);
}

/// Largest change of a body's velocity since `then` [m/s].
double GaussSeidelSolver::max_change(const std::vector<Motion6>& then) const {
  double largest = 0.0;
  for (std::size_t i = 0; i < free_.size(); ++i)
    largest = std::max(largest, (bodies_[i].motion - then[i]).head<3>().squaredNorm());
  return std::sqrt(largest);
}

// The remaining error is an impulse that both bodies lack, so it changes no momentum; the next step
// solves for it.
void GaussSeidelSolver::solve(const ContactStep& step) {
  impulses_before_.resize(points_.size());
  impulse_directions_.assign(points_.size(), PatchImpulses::Zero());
  motions_before_.resize(bodies_.size());
  motion_directions_.assign(bodies_.size(), Motion6::Zero());
  const bool rests = begin_speed(step) < kRestFallSteps * step_ * step.gravity.norm();
  const bool uneven = max_mass_ratio() > kMassRatio;
  int stack = height();
  double last = 0.0;
  for (int i = 1;; ++i) {
    if (i > 1) last = accelerate(last);
    sweep();
    const double given = max_change(free_);
    const bool converged = max_change(motions_before_) <= kConverged * given;
    if (admit_closing(step, given)) {
      stack = height();
    } else if (converged) {
      break;
    }
    if (i >= max_sweeps(stack, rests, uneven)) break;
  }
}

//     p += h m g + sum +-J,     L += sum +-(r x J + L_patch)
//
// Momenta are summed from the impulses, not taken from the velocities. So b gains what a loses up to rounding
// of the sums, however far sweeps have converged.
void GaussSeidelSolver::finish(ContactStep& step, const Island& island) {
  for (std::size_t k = 0; k < free_.size(); ++k) {
    const std::size_t index = island.bodies.begin()[k].body;
    BodyState& state = step.bodies[index];
    const Motion6 pushed = (bodies_[k].motion - free_[k]) / step_;
    state.linear_momentum += (step_ * step.scene.bodies[index].mass) * step.gravity;
    state.pushed.linear = pushed.head<3>();
    state.pushed.angular = pushed.tail<3>();
  }
  for (const ContactPatch& patch : patches_) {
    const Motion6 motion = patch.relative_motion(body(patch.a), body(patch.b));
    Motion6 impulse = Motion6::Zero();
    for (int k = 0; k < patch.count; ++k) {
      const std::size_t i = patch.first + k;
      points_[i].add_impulses(impulse);
      if (i < hand_rows_.size()) {
        patch.fill_response(step_, points_[i], motion, hand_rows_[i]);
        continue;
      }
      BodyContact& contact = step.body_contacts[linked_[i - hand_rows_.size()]];
      SpringContact row;
      row.spring = spring_of(step, contact);
      patch.fill_response(step_, points_[i], motion, row);
      settle(step, row, contact);
    }
    const Vector3 linear = patch.axes.transpose() * impulse.head<3>();
    const Vector3 angular = patch.axes.transpose() * impulse.tail<3>();
    const auto apply = [&](int body, double sign, const Vector3& arm) {
      BodyState& state = step.bodies[island.bodies.begin()[body].body];
      state.linear_momentum += sign * linear;
      state.angular_momentum += sign * (arm.cross(linear) + angular);
    };
    apply(patch.b, 1.0, patch.arm_b);
    if (patch.a != static_cast<int>(free_.size())) apply(patch.a, -1.0, patch.arm_a);
  }
  settle_hand_rows(step, island, hand_rows_.data());
  for (const Range& range : open_) {
    for (std::size_t i = range.first; i < range.last; ++i)
      step.body_contacts[i].friction = Friction::sticking;
  }
}

}  // namespace mrhi
