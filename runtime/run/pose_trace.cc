#include "runtime/run/pose_trace.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"
#include "runtime/realtime/clock.h"

namespace palpate {
namespace {

constexpr std::array<const char*, 7> kPose{"x{}_m", "y{}_m", "z{}_m", "qx{}",
                                           "qy{}",  "qz{}",  "qw{}"};

std::string named(const char* pattern, int port) {
  return fmt::format(fmt::runtime(pattern), port + 1);
}

std::string header(int ports) {
  std::string line = "time_s";
  for (int port = 0; port < ports; ++port) {
    for (const char* name : kPose) {
      line += "," + named(name, port);
    }
    for (const char* name :
         {"fx{}_n", "fy{}_n", "fz{}_n", "tx{}_n_m", "ty{}_n_m", "tz{}_n_m"}) {
      line += "," + named(name, port);
    }
  }
  return line + ",contacts,depth_m,stored_j,tank_j,dissipated_j,work_j\n";
}

void append(std::string& text, const double* values, int count) {
  for (int i = 0; i < count; ++i) {
    text += fmt::format(",{:.17g}", values[i]);
  }
}

std::vector<std::string_view> cells(std::string_view line) {
  std::vector<std::string_view> all;
  while (true) {
    const std::size_t comma = line.find(',');
    std::string_view cell = line.substr(0, comma);
    while (!cell.empty() && (cell.back() == '\r' || cell.back() == ' ')) {
      cell.remove_suffix(1);
    }
    while (!cell.empty() && cell.front() == ' ') {
      cell.remove_prefix(1);
    }
    all.push_back(cell);
    if (comma == std::string_view::npos) {
      return all;
    }
    line.remove_prefix(comma + 1);
  }
}

// Reads the columns that are wanted, line by line.
class PoseColumns {
 public:
  PoseColumns(const std::filesystem::path& file, std::string_view first, int ports)
      : file_(file) {
    const std::vector<std::string_view> names = cells(first);
    wanted_.emplace_back("time_s");
    for (int port = 0; port < ports; ++port) {
      for (const char* name : kPose) {
        wanted_.push_back(named(name, port));
      }
    }
    for (const std::string& name : wanted_) {
      const auto found = std::find(names.begin(), names.end(), name);
      if (found == names.end()) {
        throw InputError(
            fmt::format("{}: has no column \"{}\", which poses of {} hand{} "
                        "need",
                        file.string(), name, ports, ports > 1 ? "s" : ""));
      }
      column_.push_back(static_cast<std::size_t>(found - names.begin()));
    }
  }

  [[nodiscard]] std::vector<double> values(std::string_view line,
                                           std::int64_t number) const {
    const std::vector<std::string_view> cell = cells(line);
    std::vector<double> all;
    for (std::size_t i = 0; i < column_.size(); ++i) {
      double value = 0.0;
      const bool there = column_[i] < cell.size();
      const std::string_view text = there ? cell[column_[i]] : std::string_view();
      const auto read = std::from_chars(text.begin(), text.end(), value);
      if (read.ec != std::errc() || read.ptr != text.end() || !std::isfinite(value)) {
        throw InputError(
            fmt::format("{}, line {}: {} is \"{}\", must be a finite number",
                        file_.string(), number, wanted_[i], text));
      }
      all.push_back(value);
    }
    return all;
  }

 private:
  std::filesystem::path file_;
  std::vector<std::string> wanted_;
  std::vector<std::size_t> column_;
};

Eigen::Quaterniond unit(const double* xyzw) {
  Eigen::Quaterniond q(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
  constexpr double kUnit = 1e-12;
  if (std::abs(q.norm() - 1.0) > kUnit) {
    q.normalize();
  }
  return q;
}

}  // namespace

void write_pose_trace(const std::filesystem::path& file, int ports,
                      const std::vector<RenderTick>& ticks) {
  std::string text = header(ports);
  for (const RenderTick& tick : ticks) {
    text += fmt::format("{:.17g}", seconds_in(tick.time_ns));
    for (std::size_t port = 0; port < static_cast<std::size_t>(ports); ++port) {
      const Wrench& wrench = tick.command.wrench[port];
      append(text, tick.pose[port].position_m.data(), 3);
      append(text, tick.pose[port].turn.coeffs().data(), 4);  // x y z w
      append(text, wrench.force_n.data(), 3);
      append(text, wrench.torque_n_m.data(), 3);
    }
    const WrenchCommand& c = tick.command;
    text += fmt::format(",{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}\n", c.contacts,
                        c.depth_m, c.stored_j, c.tank_j, c.dissipated_j, tick.work_j);
  }
  AtomicFile out(file);
  out.write(std::as_bytes(std::span(text.data(), text.size())));
  out.commit();
}

std::vector<RenderTick> read_poses(const std::filesystem::path& file, int ports) {
  std::ifstream in(file);
  std::string line;
  if (!in || !std::getline(in, line)) {
    throw InputError(fmt::format("{}: cannot be read, or is empty", file.string()));
  }
  const PoseColumns columns(file, line, ports);
  std::vector<RenderTick> ticks;
  for (std::int64_t number = 2; std::getline(in, line); ++number) {
    if (line.empty() || line == "\r") {
      continue;
    }
    const std::vector<double> v = columns.values(line, number);
    RenderTick tick;
    tick.time_ns = std::llround(v[0] * kNanosecondsPerSecond);
    if (!ticks.empty() && !(tick.time_ns > ticks.back().time_ns)) {
      throw InputError(
          fmt::format("{}, line {}: time_s is {}, must rise by a nanosecond at least",
                      file.string(), number, v[0]));
    }
    for (std::size_t port = 0; port < static_cast<std::size_t>(ports); ++port) {
      // Seven numbers a hand after the time: x y z [m], quaternion x y z w.
      const double* at = &v[1 + 7 * port];
      if (Eigen::Map<const Eigen::Vector4d>(at + 3).isZero(0.0)) {
        throw InputError(fmt::format("{}, line {}: hand {} has a quaternion of zeros",
                                     file.string(), number, port + 1));
      }
      tick.pose[port] = {Eigen::Map<const Eigen::Vector3d>(at), unit(at + 3)};
    }
    ticks.push_back(tick);
  }
  if (ticks.empty()) {
    throw InputError(fmt::format("{}: has no poses", file.string()));
  }
  return ticks;
}

}  // namespace palpate
