#include "contender.h"

#include <cmath>
#include <ctime>
#include <iostream>

#include "text/files.h"

namespace mrhi::benchmark {
namespace {

std::string version_of(const std::string& engine) {
  for (const EngineModule& module : engine_modules())
    if (module.name == engine) return module.version;
  return "";
}

/// ISO 8601, UTC.
std::string today() {
  const std::time_t now = std::time(nullptr);
  char text[16];
  return std::string(text, std::strftime(text, sizeof text, "%Y-%m-%d", std::gmtime(&now)));
}

void write_row(std::ostream& csv, const std::string& scene, const Contender& contender, double step,
               const Measure& measure) {
  const StepTime& time = contender.result().time;
  (CsvRows(csv) << scene + measure.suffix << contender.engine() << contender.setting() << step << time.median
                << time.percentile_99 << measure.error << measure.unit
                << (measure.failed || !std::isfinite(measure.error)) << version_of(contender.engine())
                << today())
      .end_row();
}

}  // namespace

void write_header(std::ostream& csv) {
  csv.precision(9);
  csv << "scene,engine,setting,step_s,us_per_step,us_per_step_p99,error,error_unit,failed,engine_version,"
         "date\n";
}

void write_rows(std::ostream& csv, const std::string& scene, double step,
                const std::vector<std::unique_ptr<Contender>>& contenders,
                std::map<std::string, std::vector<Measure>>& measures) {
  for (const auto& contender : contenders)
    if (!contender->result().measures.empty()) measures[scene] = contender->result().measures;
  for (const auto& contender : contenders) {
    if (!contender->result().supported) continue;
    std::vector<Measure> rows = contender->result().measures;
    if (!contender->trouble().empty()) {
      std::cerr << scene << ", " << contender->engine() << " (" << contender->setting() << "), step "
                << 1e3 * step << " ms: " << contender->trouble() << '\n';
      if (rows.empty()) rows = measures[scene];
      for (Measure& row : rows) row.error = std::nan(""), row.failed = true;
    }
    for (const Measure& row : rows) write_row(csv, scene, *contender, step, row);
  }
}

void write_times_header(std::ostream& csv) {
  csv.precision(9);
  csv << "scene,engine,setting,step_s,us_mean,us_median,us_p99,us_max\n";
}

void write_times(std::ostream& csv, const std::string& scene, double step,
                 const std::vector<std::unique_ptr<Contender>>& contenders) {
  for (const auto& contender : contenders) {
    if (!contender->result().supported || !contender->trouble().empty()) continue;
    const StepTime& time = contender->result().time;
    (CsvRows(csv) << scene << contender->engine() << contender->setting() << step << time.mean << time.median
                  << time.percentile_99 << time.most)
        .end_row();
  }
}

}  // namespace mrhi::benchmark
