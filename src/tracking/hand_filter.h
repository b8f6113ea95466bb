#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "../text/yaml.h"
#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/interaction.h"
#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {

/// A setting of a filter: the parameter filter/NAME. If it is optional, `word` stands for a value that the
/// filter estimates itself, and `meaning` explains it.
struct FilterSetting {
  using Value = std::variant<int FilterConfiguration::*, double FilterConfiguration::*,
                             std::optional<double> FilterConfiguration::*>;

  const char* name;
  const char* unit;  ///< " [Hz]"
  Range range, slider;
  Value value;
  const char* word = "";
  const char* meaning = "";
};

/// The entry of a filter. The file src/tracking/NAME_filter.cpp defines NAME_filter; the build adds it to
/// hand_filters().
struct HandFilter {
  const char* name;
  int place;  ///< in lists and in recorded states: a new filter comes last
  std::vector<FilterSetting> (*settings)();
  /// Number of newest samples that pass() uses, at least 1.
  int (*samples_needed)(const FilterConfiguration& filter);
  /// Returns the filtered hand. The newest sample, taken `elapsed` seconds after the previous one, is at the
  /// front of the memory's history. The rest of the memory is as the previous frame left it; the caller
  /// updates `filtered`.
  Hand (*pass)(double elapsed, const FilterConfiguration& filter, FilterMemory& memory);
};

/// In the order of their places.
const std::vector<const HandFilter*>& hand_filters();

/// Throws std::invalid_argument for a name that is not known.
const HandFilter& hand_filter(FilterKind kind);

/// The settings of all filters, filter by filter.
const std::vector<FilterSetting>& filter_settings();

/// The filter of a configuration: Eq. 1 as printed under seed/literal, else the filter's type.
FilterConfiguration filter_of(const Configuration& configuration);

/// The filtered hand for `sample`, taken `elapsed` seconds (above 0) after the one before. A memory that is
/// empty starts with `sample` as it is. All points of a hand are filtered alike: a joint that two bones share
/// stays one joint. docs/pipeline.md compares the filters.
///
/// One gain for all points keeps what is linear in them: what is midway between two others stays so. Lengths
/// of bones are not, and change while a hand turns: a mean of two directions is shorter than either.
Hand filtered(const Hand& sample, double elapsed, const FilterConfiguration& filter, FilterMemory& memory);

/// Two third differences of four samples each, one sample apart.
constexpr int kNoiseSamples = 5;  ///< of the history, from which observe_noise learns

/// Updates the noise estimate from the newest samples. Does nothing with fewer than kNoiseSamples.
void observe_noise(const SampleHistory& history, SeenNoise& noise);

/// Rms noise of a sample on an axis that a filter assumes [m]: a good tracker's, plus the observed excess.
///     sigma^2 = kUsualNoise^2 + max(0, s^2 - (1 mm)^2),   s^2 the observed variance
double filter_noise(const SeenNoise& seen);

/// Assigns the frame's hands to tracks (by id; a new id on the same side, near a hand that is held, continues
/// it), filters them, holds those that are missing, and reports hand_found. Call lose_unseen_hands first.
/// `elapsed`: since the frame before [s]. `people`, at least 1: hands whose ids differ modulo this are of
/// different people, and do not continue each other. `hands` has kMaxHands slots; further hands are left out.
void track_hands(const HandFrame& frame, double elapsed, std::uint32_t people,
                 const Configuration& configuration, std::vector<HandTrack>& hands,
                 std::vector<Event>& events);

/// Changes the filter at `now`. Positions and velocities stay continuous; the change takes 0.2 s.
void change_filter(const FilterConfiguration& from, Nanoseconds now, std::vector<HandTrack>& hands);

/// Ends every track that was last seen more than hold_time before `now`, with hand_lost.
void lose_unseen_hands(Nanoseconds now, double hold_time, std::vector<HandTrack>& hands,
                       std::vector<Event>& events);

}  // namespace mrhi
