#include "tuning.h"

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <map>
#include <utility>

#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/ros/server_parameters.h"

namespace mrhi {
namespace {

using Config = mr_hand_interaction::TuneConfig;

const std::string kStiffness = "material/stiffness", kNoise = "filter/noise";

std::string number(double value) {
  return yaml_text(XmlRpc::XmlRpcValue(value));
}

dynamic_reconfigure::Config message_of(const Config& config) {
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  return message;
}

std::string field_of(std::string parameter) {
  std::replace(parameter.begin(), parameter.end(), '/', '_');
  return parameter;
}

/// By the name of the parameter, of those that have one.
std::map<std::string, std::string> parameter_texts(const Config& config) {
  std::map<std::string, std::string> fields;
  const dynamic_reconfigure::Config message = message_of(config);
  for (const auto& field : message.ints) fields[field.name] = std::to_string(field.value);
  for (const auto& field : message.doubles) fields[field.name] = number(field.value);
  for (const auto& field : message.strs) fields[field.name] = field.value;
  std::map<std::string, std::string> texts;
  for (const std::string& name : parameter_names()) {
    const auto field = fields.find(field_of(name));
    if (field != fields.end()) texts[name] = field->second;
  }
  return texts;
}

/// Who moves a number means it, also where it was the scene's or the model's own until then.
void add_gravity(const Config& wanted, const Config& before, Tuning::Values& values) {
  const bool moved = wanted.gravity_x != before.gravity_x || wanted.gravity_y != before.gravity_y ||
                     wanted.gravity_z != before.gravity_z;
  if (!moved && wanted.gravity_of_scene == before.gravity_of_scene) return;
  const bool of_scene = wanted.gravity_of_scene && !(moved && before.gravity_of_scene);
  values.emplace_back("gravity", of_scene ? "scene"
                                          : "[" + number(wanted.gravity_x) + ", " + number(wanted.gravity_y) +
                                                ", " + number(wanted.gravity_z) + "]");
}

void add_stiffness(const Config& wanted, const Config& before, Tuning::Values& values) {
  const bool moved = wanted.material_stiffness != before.material_stiffness;
  if (!moved && wanted.stiffness_of_model == before.stiffness_of_model) return;
  const bool of_model = wanted.stiffness_of_model && !(moved && before.stiffness_of_model);
  values.emplace_back(kStiffness, of_model ? "model" : number(wanted.material_stiffness));
}

void add_noise(const Config& wanted, const Config& before, Tuning::Values& values) {
  const bool moved = wanted.filter_noise != before.filter_noise;
  if (!moved && wanted.filter_noise_estimated == before.filter_noise_estimated) return;
  const bool estimated = wanted.filter_noise_estimated && !(moved && before.filter_noise_estimated);
  values.emplace_back(kNoise, estimated ? "estimated" : number(wanted.filter_noise));
}

/// The parameter that a number of the dialog belongs to: gravity has one for each axis.
std::string parameter_of(const std::string& field) {
  for (const std::string& name : parameter_names()) {
    if (field_of(name) == field) return name;
  }
  return field.substr(0, field.rfind('_'));
}

template <class Field>
void set_ends(std::vector<Field>& least, std::vector<Field>& most) {
  for (std::size_t i = 0; i < least.size(); ++i) {
    const ParameterLimits limits = parameter_limits(parameter_of(least[i].name)).value();
    least[i].value = static_cast<decltype(least[i].value)>(limits.slider_min);
    most[i].value = static_cast<decltype(most[i].value)>(limits.slider_max);
  }
}

}  // namespace

void slider_ends(Config& least, Config& most) {
  dynamic_reconfigure::Config low = message_of(least), high = message_of(most);
  set_ends(low.ints, high.ints);
  set_ends(low.doubles, high.doubles);
  least.__fromMessage__(low);
  most.__fromMessage__(high);
}

Tuning::Tuning(const ros::NodeHandle& private_node, bool place_by_mouse, Actions actions)
    : actions_(std::move(actions)),
      place_by_mouse_(place_by_mouse),
      server_(mutex_, ros::NodeHandle(private_node, "tune")) {
  Config least = current(), most = least;
  slider_ends(least, most);
  server_.setConfigMin(least);
  server_.setConfigMax(most);
  shown_ = current();
  server_.updateConfig(shown_);
  server_.setCallback([this](Config& wanted, std::uint32_t) { take(wanted); });
  teller_ = std::thread([this] { tell(); });
}

Tuning::~Tuning() {
  {
    const std::lock_guard<std::mutex> lock(asking_);
    ends_ = true;
  }
  asked_.notify_one();
  teller_.join();
}

void Tuning::show() {
  shown_ = current();
  const std::lock_guard<std::mutex> lock(asking_);
  to_tell_ = shown_;
  asked_.notify_one();
}

/// The server's mutex comes first: what its callback has changed meanwhile is newer than what was to be told.
void Tuning::tell() {
  while (true) {
    {
      std::unique_lock<std::mutex> lock(asking_);
      asked_.wait(lock, [this] { return to_tell_ || ends_; });
      if (ends_) return;
    }
    const boost::recursive_mutex::scoped_lock server(mutex_);
    std::unique_lock<std::mutex> lock(asking_);
    const std::optional<Config> config = std::exchange(to_tell_, std::nullopt);
    lock.unlock();
    if (config) server_.updateConfig(*config);
  }
}

void Tuning::take(Config& wanted) {
  try {
    const Values values = changes(wanted);
    if (!values.empty()) actions_.set(values);
    if (wanted.place_by_mouse != place_by_mouse_) actions_.place_by_mouse(wanted.place_by_mouse);
    place_by_mouse_ = wanted.place_by_mouse;
  } catch (const std::exception& error) {
    ROS_WARN("not changed: %s", error.what());
  }
  wanted = shown_ = current();
  const std::lock_guard<std::mutex> lock(asking_);
  to_tell_.reset();
}

Tuning::Values Tuning::changes(const Config& wanted) const {
  Values values;
  const auto before = parameter_texts(shown_);
  for (const auto& [name, text] : parameter_texts(wanted)) {
    if (name != kStiffness && name != kNoise && text != before.at(name)) values.emplace_back(name, text);
  }
  add_gravity(wanted, shown_, values);
  add_stiffness(wanted, shown_, values);
  add_noise(wanted, shown_, values);
  return values;
}

Config Tuning::current() const {
  const Simulation& simulation = actions_.simulation();
  const Configuration& configuration = simulation.configuration();
  dynamic_reconfigure::Config message = message_of(Config::__getDefault__());
  for (const std::string& name : parameter_names()) {
    const std::string field = field_of(name);
    const std::string text = parameter_text(configuration, name);
    for (auto& entry : message.ints)
      if (entry.name == field) entry.value = std::atoi(text.c_str());
    for (auto& entry : message.doubles)
      if (entry.name == field) entry.value = std::strtod(text.c_str(), nullptr);
    for (auto& entry : message.strs)
      if (entry.name == field) entry.value = text;
  }
  Config config;
  config.__fromMessage__(message);
  const Vector3 gravity = configuration.gravity.value_or(simulation.scene().gravity);
  config.gravity_of_scene = !configuration.gravity;
  config.gravity_x = gravity.x(), config.gravity_y = gravity.y(), config.gravity_z = gravity.z();
  config.filter_noise_estimated = !configuration.filter.noise;
  config.filter_noise = configuration.filter.noise.value_or(kUsualNoise);
  config.stiffness_of_model = !configuration.stiffness;
  config.material_stiffness = default_material(configuration).stiffness;
  config.place_by_mouse = place_by_mouse_;
  return config;
}

}  // namespace mrhi
