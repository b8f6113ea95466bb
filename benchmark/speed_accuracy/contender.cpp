#include "contender.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <sstream>
#include <stdexcept>

namespace mrhi::benchmark {
namespace {

// Messages of a contender: 'p' after each block; finally a report, ended by a line "end".
constexpr char kPause = 'p';
constexpr double kLongestBlock = 30.0;  // [s]

std::string one_line(std::string text) {
  for (char& c : text)
    if (c == '\n' || c == '\t') c = ' ';
  return text;
}

std::string report_of(const RunResult& result) {
  std::ostringstream out;
  out.precision(17);
  out << "supported\t" << result.supported << "\ntime\t" << result.time.median << '\t'
      << result.time.percentile_99 << '\t' << result.time.mean << '\t' << result.time.most << '\n';
  if (!result.trouble.empty()) out << "trouble\t" << one_line(result.trouble) << '\n';
  for (const Measure& m : result.measures)
    out << "measure\t" << m.suffix << '\t' << m.error << '\t' << m.unit << '\t' << m.failed << '\n';
  return out.str();
}

void send(int pipe, const std::string& text) {
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t n = write(pipe, text.data() + sent, text.size() - sent);
    if (n <= 0) _exit(1);
    sent += static_cast<std::size_t>(n);
  }
}

/// Silences the output of peers, so that the program's own stays readable.
void silence_output() {
  const int nowhere = open("/dev/null", O_WRONLY);
  if (nowhere < 0 || dup2(nowhere, STDOUT_FILENO) < 0 || dup2(nowhere, STDERR_FILENO) < 0) _exit(1);
}

struct Pipes {
  int read_end, write_end;
};
Pipes make_pipe() {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe to a contender");
  return {ends[0], ends[1]};
}

std::vector<std::string> fields(const std::string& line) {
  std::vector<std::string> result(1);
  for (const char c : line) {
    if (c == '\t') {
      result.emplace_back();
    } else {
      result.back() += c;
    }
  }
  return result;
}

}  // namespace

Contender::Contender(const EngineModule& module, const std::string& setting, const ScenePlan& scene,
                     bool quick, double step, double seconds)
    : engine_(module.name), setting_(setting) {
  const Pipes down = make_pipe(), up = make_pipe();
  process_ = fork();
  if (process_ < 0) throw std::runtime_error("no process for a contender");
  if (process_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    close(down.write_end), close(up.read_end);
    silence_output();
    const auto wait = [&down] {
      char go;
      if (read(down.read_end, &go, 1) != 1) _exit(1);
    };
    wait();
    std::string report;
    try {
      const auto experiment = scene.make(quick);
      const auto pause = [&] {
        send(up.write_end, std::string(1, kPause));
        wait();
      };
      report = report_of(run_experiment(load(module.file), setting, *experiment, step, seconds, pause));
    } catch (const std::exception& error) {
      report = "trouble\t" + one_line(error.what()) + "\n";
    }
    send(up.write_end, report + "end\n");
    _exit(0);
  }
  close(down.read_end), close(up.write_end);
  to_child_ = down.write_end;
  from_child_ = up.read_end;
}

Contender::~Contender() {
  close(to_child_), close(from_child_);
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

bool Contender::work() {
  if (write(to_child_, "g", 1) != 1) {
    result_.trouble = "crashed";
    return false;
  }
  while (true) {
    pollfd wait{from_child_, POLLIN, 0};
    if (poll(&wait, 1, static_cast<int>(1e3 * kLongestBlock)) == 0) {
      result_.trouble = "does not come back from a step";
      return false;
    }
    char buffer[4096];
    const ssize_t n = read(from_child_, buffer, sizeof(buffer));
    if (n <= 0) {
      result_.trouble = "crashed";
      return false;
    }
    if (n == 1 && buffer[0] == kPause && received_.empty()) break;
    received_.append(buffer, static_cast<std::size_t>(n));
    if (received_.size() < 4 || received_.compare(received_.size() - 4, 4, "end\n") != 0) continue;
    finish(received_);
    return false;
  }
  return true;
}

void Contender::finish(const std::string& report) {
  std::istringstream lines(report);
  for (std::string line; std::getline(lines, line) && line != "end";) {
    const std::vector<std::string> f = fields(line);
    if (f[0] == "trouble") result_.trouble = f.at(1);
    if (f[0] == "supported") result_.supported = f.at(1) == "1";
    if (f[0] == "time")
      result_.time = {std::stod(f.at(1)), std::stod(f.at(2)), std::stod(f.at(3)), std::stod(f.at(4))};
    if (f[0] == "measure") result_.measures.push_back({f.at(1), std::stod(f.at(2)), f.at(3), f.at(4) == "1"});
  }
}

}  // namespace mrhi::benchmark
