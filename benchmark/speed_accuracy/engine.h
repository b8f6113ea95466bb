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

/// One world in one physics engine, with a fixed step.
class Engine {
 public:
  virtual ~Engine() = default;
  /// Sets the pose of a part of the hand at the start and end of the step. Not part of the measured time.
  virtual void move(std::size_t kinematic, const Pose& now, const Pose& next) = 0;
  /// Called once all parts have been moved, before step(). Not part of the measured time.
  virtual void before_step() {}
  /// Measured: collision, contact, integration.
  virtual void step() = 0;
  /// Called after step(). Not part of the measured time.
  virtual void after_step() {}
  virtual Motion motion(std::size_t body) const = 0;
  /// Enables pressing(); call before the first step.
  virtual void watch_forces() {}
  /// Load on a part of the hand in the last step: the sum of its contacts' forces [N].
  virtual double pressing(std::size_t /*kinematic*/) const { return std::nan(""); }
};

/// Factory of an engine's worlds. One object in each engine's module.
class EngineMaker {
 public:
  virtual ~EngineMaker() = default;
  /// The engine's defaults and the best settings found, each described reproducibly.
  virtual std::vector<std::string> settings() const = 0;
  /// Returns null if the engine does not support this world.
  virtual std::unique_ptr<Engine> make(const std::string& setting, const World& world, double step) const = 0;
};

/// True if an engine declares support of hinges: kHinges.
template <typename EngineType, typename = void>
constexpr bool kHasHinges = false;
template <typename EngineType>
constexpr bool kHasHinges<EngineType, std::void_t<decltype(EngineType::kHinges)>> = true;

/// True if an engine declares support of meshes as bodies: kMeshes.
template <typename EngineType, typename = void>
constexpr bool kHasMeshes = false;
template <typename EngineType>
constexpr bool kHasMeshes<EngineType, std::void_t<decltype(EngineType::kMeshes)>> = true;

inline bool has_meshes(const World& world) {
  return std::any_of(world.bodies.begin(), world.bodies.end(),
                     [](const BodySpec& body) { return std::holds_alternative<Mesh>(body.shape); });
}

/// Factory of an engine that supports every world, except hinges and meshes, with a table of its settings.
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

/// The only symbol that an engine's module exports.
#define MRHI_ENGINE_MODULE(Maker)                                                       \
  extern "C" __attribute__((visibility("default"))) const mrhi::benchmark::EngineMaker* \
  speed_accuracy_engine() {                                                             \
    static const Maker maker;                                                           \
    return &maker;                                                                      \
  }
