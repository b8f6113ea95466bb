#include "arguments.h"

#include <algorithm>
#include <cstdlib>

#include "mr_hand_interaction/parameters.h"
#include "text/text.h"

namespace mrhi::real_grasps {
namespace {

std::vector<Row> rows_of(const std::string& names) {
  const std::vector<Row> all = all_rows();
  std::vector<Row> rows;
  for (const std::string& name : text::split(names)) {
    const auto row = std::find_if(all.begin(), all.end(), [&](const Row& r) { return r.name == name; });
    if (row == all.end()) {
      std::string known;
      for (const Row& r : all) known += (known.empty() ? "" : ", ") + r.name;
      throw UsageError("--only: '" + name + "' is unknown; known: " + known);
    }
    rows.push_back(*row);
  }
  return rows;
}

void set(const std::string& setting, Configuration& configuration) {
  const std::size_t equals = setting.find('=');
  if (equals == std::string::npos) throw UsageError("--set '" + setting + "': KEY=VALUE is needed");
  set_parameter(configuration, setting.substr(0, equals), setting.substr(equals + 1));
}

double number_of(const std::string& option, const std::string& value, double least, double most) {
  char* end = nullptr;
  const double number = std::strtod(value.c_str(), &end);
  if (value.empty() || *end != '\0' || !(number >= least && number <= most)) {
    std::ostringstream allowed;
    allowed << option << ": '" << value << "' is not a number of " << least << " to " << most;
    throw UsageError(allowed.str());
  }
  return number;
}

void take(const std::string& option, const std::string& value, Arguments& arguments) {
  if (option == "--set") {
    set(value, arguments.configuration);
  } else if (option == "--only") {
    arguments.rows = rows_of(value);
  } else if (option == "--output") {
    arguments.output = value;
  } else if (option == "--arctic") {
    arguments.arctic = value;
  } else if (option == "--lead") {
    arguments.lead = number_of(option, value, 0.0, 10.0);
  } else if (option == "--noise") {
    arguments.disturbance.noise = 1e-3 * number_of(option, value, 0.0, 50.0);
  } else if (option == "--rate") {
    arguments.disturbance.rate = number_of(option, value, 5.0, 1000.0);
  } else if (option == "--seeds") {
    arguments.seeds = static_cast<unsigned>(number_of(option, value, 1.0, 1000.0));
  } else if (option == "--engine") {
    arguments.engines.push_back(value);
  } else if (option == "--jobs") {
    arguments.jobs = static_cast<unsigned>(number_of(option, value, 1.0, 64.0));
  } else {
    throw UsageError("unknown option " + option);
  }
}

}  // namespace

Arguments parse_arguments(const std::vector<std::string>& words) try {
  Arguments arguments;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word == "--help" || word == "-h") {
      arguments.help = true;
      return arguments;
    }
    if (word == "--list") {
      arguments.list = true;
    } else if (word == "--compare") {
      arguments.compare = true;
    } else if (word.compare(0, 2, "--") != 0) {
      arguments.paths.push_back(word);
    } else if (i + 1 == words.size()) {
      throw UsageError(word + ": a value is missing, or the option is unknown");
    } else {
      take(word, words[++i], arguments);
    }
  }
  validate(arguments.configuration);
  if (arguments.paths.empty() && arguments.arctic.empty())
    throw UsageError("a folder of recordings or --arctic is needed; see --help");
  return arguments;
} catch (const ParameterError& error) {
  throw UsageError(error.what());
}

const char* help_text() {
  return R"(usage: real_grasps [OPTION]... [--arctic DIR] FOLDER...
Puts bodies at rest (0 g) where recorded hands close and tells how many are held until the hand opens.
  FOLDER            recordings in the CSV schema, or single files
  --set KEY=VALUE   a parameter, as replay's; repeatable
  --only ROW,...    pinch20, pinch30, pinch40, grab_sphere60, grab_sphere80, grab_cube60, grab_cube80; at 1 g on a
                    column: rest_sphere60, rest_sphere100, rest_cube60, rest_cube100; hands that stay open round it,
                    of which none is to be held: pass_sphere40, pass_cube40, pass_sphere60, pass_cube60
  --list            one line for each closing
  --noise RMS_MM    white noise on each joint and axis; 0 if not said
  --rate HZ         frames evenly spaced at this rate; as recorded if not said
  --seeds N         each closing is played N times with other noise; 1 if not said
  --compare         our models in several stiffnesses
  --engine FILE     a physics engine too: its module, .../speed_accuracy_NAME.so; repeatable
  --output DIR      writes real_grasps.csv, real_grasps_events.csv (a line for each closing) and, with --arctic,
                    real_grasps_arctic.csv
  --arctic DIR      plays the windows that arctic_windows.py cut into DIR: captured hands on captured objects
  --lead SECONDS    for which such an object is led before it is let free; 1 if not said, 0: hands appear on it
  --jobs N          recordings at the same time; 1 if not said
docs/real_grasps.md says what the figures mean.
)";
}

}  // namespace mrhi::real_grasps
