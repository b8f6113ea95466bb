#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "world.h"

namespace mrhi::benchmark {

struct Motion {
  Pose pose;    ///< of the centre of mass
  Twist twist;  ///< world axes
};

/// One world in one physics engine, advanced by one step length.
class Engine {
 public:
  virtual ~Engine() = default;
  /// Where the hand's part is as the step begins and as it ends. Not part of the measured time.
  virtual void move(std::size_t kinematic, const Pose& now, const Pose& next) = 0;
  /// Called once all parts have been moved, before step(). Not part of the measured time.
  virtual void before_step() {}
  /// Collision, contact, integration: what is measured.
  virtual void step() = 0;
  /// Called after step(). Not part of the measured time.
  virtual void after_step() {}
  virtual Motion motion(std::size_t body) const = 0;
  /// Asks that pressing() be told; before the first step.
  virtual void watch_forces() {}
  /// How hard the hand's part is pressed, as the last step found: the sum of its contacts' forces [N].
  virtual double pressing(std::size_t /*kinematic*/) const { return std::nan(""); }
};

/// How worlds of one engine are made. One object in each engine's module.
class EngineMaker {
 public:
  virtual ~EngineMaker() = default;
  /// The engine as it comes, and the best settings found, each described so that it can be repeated.
  virtual std::vector<std::string> settings() const = 0;
  /// Nothing if the engine has no means for this world.
  virtual std::unique_ptr<Engine> make(const std::string& setting, const World& world, double step) const = 0;
};

/// Whether an engine says that it has hinges: kHinges.
template <typename EngineType, typename = void>
constexpr bool kHasHinges = false;
template <typename EngineType>
constexpr bool kHasHinges<EngineType, std::void_t<decltype(EngineType::kHinges)>> = true;

/// Whether an engine says that bodies may be meshes: kMeshes.
template <typename EngineType, typename = void>
constexpr bool kHasMeshes = false;
template <typename EngineType>
constexpr bool kHasMeshes<EngineType, std::void_t<decltype(EngineType::kMeshes)>> = true;

inline bool has_meshes(const World& world) {
  return std::any_of(world.bodies.begin(), world.bodies.end(),
                     [](const BodySpec& body) { return std::holds_alternative<Mesh>(body.shape); });
}

/// Makes engines that can do every world, but for hinges and meshes, by a table of their settings.
template <typename EngineType, const auto& kTable>
class TableMaker final : public EngineMaker {
 public:
  std::vector<std::string> settings() const override {
    std::vector<std::string> names;
    for (const auto& setting : kTable) names.push_back(setting.name);
    return names;
  }
  std::unique_ptr<Engine> make(const std::string& name, const World& world, double step) const override {
    if (!world.hinges.empty() && !kHasHinges<EngineType>) return nullptr;
    if (has_meshes(world) && !kHasMeshes<EngineType>) return nullptr;
    for (const auto& setting : kTable)
      if (name == setting.name) return std::make_unique<EngineType>(setting, world, step);
    return nullptr;
  }
};

}  // namespace mrhi::benchmark

/// The one symbol that an engine's module exports.
#define MRHI_ENGINE_MODULE(Maker)                                                       \
  extern "C" __attribute__((visibility("default"))) const mrhi::benchmark::EngineMaker* \
  speed_accuracy_engine() {                                                             \
    static const Maker maker;                                                           \
    return &maker;                                                                      \
  }
