#include "runtime/attach/probe_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/atomic_file.h"
#include "formats/base/error.h"
#include "formats/base/input_file.h"
#include "formats/base/json_text.h"
#include "formats/base/printable.h"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kProbeFormat = "palpate probe";
constexpr int kProbeVersion = 1;
constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};

Json as_list(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

// In whole microseconds and nanometres: finer than any device.
Json push_json(const std::vector<ProbeSample>& push) {
  Json time_us = Json::array();
  Json way_nm = Json::array();
  for (const ProbeSample& sample : push) {
    time_us.push_back(std::llround(1e6 * sample.time_s));
    way_nm.push_back(std::llround(1e9 * sample.way_m));
  }
  return {{"time_us", time_us}, {"way_nm", way_nm}};
}

Json axis_json(const ProbedAxis& a) {
  Json json = {{"axis", kAxes[static_cast<std::size_t>(a.axis)]}};
  if (!a.failure.empty()) {
    json["failure"] = a.failure;
    return json;
  }
  json.update({{"friction_n", a.friction_n},
               {"friction_sd_n", a.friction_sd_n},
               {"mass_kg", a.mass_kg},
               {"damping_n_s_per_m", a.damping_n_s_per_m},
               {"damping_sd_n_s_per_m", a.damping_sd_n_s_per_m},
               {"delay_s", a.delay_s},
               {"delay_resolution_s", a.delay_resolution_s},
               {"pushes", Json::array()}});
  for (const std::vector<ProbeSample>& push : a.push) {
    json["pushes"].push_back(push_json(push));
  }
  return json;
}

// Reads what is there and can be; names what is not.
class ProbeReader {
 public:
  ProbeReader(const std::filesystem::path& file, const Json& json)
      : file_(file), json_(json) {}

  [[noreturn]] void refuse(const std::string& why) const {
    throw FormatError(fmt::format("{}: {}", file_.string(), why));
  }

  [[nodiscard]] double number(const Json& from, const char* key, double low,
                              double high) const {
    const auto at = from.find(key);
    const double value = at != from.end() && at->is_number()
                             ? at->get<double>()
                             : std::numeric_limits<double>::quiet_NaN();
    if (!(value >= low && value <= high)) {
      refuse(fmt::format("{} is missing or {}, must be a number in [{}, {}]", key,
                         value, low, high));
    }
    return value;
  }

  [[nodiscard]] std::string text(const Json& from, const char* key) const {
    const auto at = from.find(key);
    if (at == from.end() || !at->is_string() ||
        at->get_ref<const std::string&>().size() > 200) {
      refuse(fmt::format("{} is missing, must be a short text", key));
    }
    return at->get<std::string>();
  }

  [[nodiscard]] const Json& list(const Json& from, const char* key, std::size_t low,
                                 std::size_t high) const {
    const auto at = from.find(key);
    if (at == from.end() || !at->is_array() || at->size() < low || at->size() > high) {
      refuse(fmt::format("{} is missing, must be a list of {} to {}", key, low, high));
    }
    return *at;
  }

  [[nodiscard]] Eigen::Vector3d place(const char* key) const {
    Eigen::Vector3d v = Eigen::Vector3d::Zero();
    const Json& three = list(json_, key, 3, 3);
    for (std::size_t i = 0; i < 3; ++i) {
      const Json one = {{key, three[i]}};
      v[static_cast<Eigen::Index>(i)] = number(one, key, -10.0, 10.0);
    }
    return v;
  }

  [[nodiscard]] std::vector<ProbeSample> push(const Json& from) const {
    constexpr std::size_t kSamplesMax = 100'000;
    const Json& time_us = list(from, "time_us", 1, kSamplesMax);
    const Json& way_nm = list(from, "way_nm", time_us.size(), time_us.size());
    std::vector<ProbeSample> samples;
    for (std::size_t i = 0; i < time_us.size(); ++i) {
      if (!time_us[i].is_number() || !way_nm[i].is_number()) {
        refuse("a push has what is no number");
      }
      samples.push_back(
          {1e-6 * time_us[i].get<double>(), 1e-9 * way_nm[i].get<double>()});
    }
    return samples;
  }

  [[nodiscard]] ProbedAxis axis(const Json& from) const {
    ProbedAxis a;
    const std::string name = from.is_object() ? text(from, "axis") : "";
    const auto known = std::find(kAxes.begin(), kAxes.end(), name);
    if (known == kAxes.end()) {
      refuse(fmt::format("axis \"{}\" is none of x, y and z", name));
    }
    a.axis = static_cast<int>(known - kAxes.begin());
    if (from.contains("failure")) {
      a.failure = text(from, "failure");
      return a;
    }
    a.friction_n = number(from, "friction_n", -1.0, 10.0);
    a.friction_sd_n = number(from, "friction_sd_n", 0.0, 10.0);
    a.mass_kg = number(from, "mass_kg", 1e-6, 1e3);
    // Beyond any mechanism that a hand moves.
    a.damping_n_s_per_m = number(from, "damping_n_s_per_m", -50.0, 50.0);
    a.damping_sd_n_s_per_m = number(from, "damping_sd_n_s_per_m", 0.0, 1e6);
    a.delay_s = number(from, "delay_s", 0.0, 1.0);
    a.delay_resolution_s = number(from, "delay_resolution_s", 0.0, 10.0);
    for (const Json& one : list(from, "pushes", 0, 1000)) {
      a.push.push_back(push(one));
    }
    return a;
  }

  [[nodiscard]] ProbeReport report() const {
    constexpr double kMany = 1e12;
    if (!json_.is_object() || json_.value("format", Json()) != kProbeFormat ||
        json_.value("version", Json()) != kProbeVersion) {
      refuse(fmt::format("is no probe: format must be \"{}\" and version {}",
                         kProbeFormat, kProbeVersion));
    }
    ProbeReport r;
    r.device = text(json_, "device");
    r.palpate = text(json_, "palpate");
    r.by_hand = json_.value("by_hand", Json()) == true;
    r.exchanges = static_cast<std::int64_t>(number(json_, "exchanges", 1.0, kMany));
    r.missed = static_cast<std::int64_t>(number(json_, "missed", 0.0, kMany));
    r.free_rate_hz = number(json_, "rate_hz", 0.0, 1e7);
    r.exchange_p50_s = number(json_, "exchange_p50_s", 0.0, 1e3);
    r.exchange_p99_s = number(json_, "exchange_p99_s", 0.0, 1e3);
    r.exchange_max_s = number(json_, "exchange_max_s", 0.0, 1e3);
    r.resolution_m = number(json_, "resolution_m", 0.0, 0.1);
    r.push_n = number(json_, "push_n", 0.0, kProbeForceMaxN);
    r.force_max_n = number(json_, "force_max_n", 0.0, 1.001 * kProbeForceMaxN);
    r.lowest_m = place("lowest_m");
    r.highest_m = place("highest_m");
    for (const Json& one : list(json_, "axes", 1, 3)) {
      r.axis.push_back(axis(one));
    }
    return r;
  }

 private:
  const std::filesystem::path& file_;
  const Json& json_;
};

std::string axis_text(const ProbedAxis& a) {
  const char* const name = kAxes[static_cast<std::size_t>(a.axis)];
  if (!a.failure.empty()) {
    return fmt::format("along {}: {}\n", name, printable(a.failure));
  }
  const std::string delay =
      a.has_delay() ? fmt::format("{:.3g} ms, +- {:.1g}", 1e3 * a.delay_s,
                                  1e3 * a.delay_resolution_s)
                    : fmt::format("below {:.2g} ms, which is as fine as this can tell",
                                  1e3 * (a.delay_s + a.delay_resolution_s));
  return fmt::format(
      "along {}\n"
      "  dry friction       {:.3g} N, +- {:.1g}\n"
      "  mass               {:.3g} kg\n"
      "  damping            {:.2g} N s/m, +- {:.1g}\n"
      "  delay of forces    {}\n",
      name, a.friction_n, 2.0 * a.friction_sd_n, a.mass_kg, a.damping_n_s_per_m,
      2.0 * a.damping_sd_n_s_per_m, delay);
}

}  // namespace

std::string probe_json(const ProbeReport& r) {
  Json json = {{"format", kProbeFormat},
               {"version", kProbeVersion},
               {"device", r.device},
               {"palpate", r.palpate},
               {"by_hand", r.by_hand},
               {"exchanges", r.exchanges},
               {"missed", r.missed},
               {"rate_hz", r.free_rate_hz},
               {"exchange_p50_s", r.exchange_p50_s},
               {"exchange_p99_s", r.exchange_p99_s},
               {"exchange_max_s", r.exchange_max_s},
               {"resolution_m", r.resolution_m},
               {"push_n", r.push_n},
               {"force_max_n", r.force_max_n},
               {"lowest_m", as_list(r.lowest_m)},
               {"highest_m", as_list(r.highest_m)},
               {"axes", Json::array()}};
  for (const ProbedAxis& axis : r.axis) {
    json["axes"].push_back(axis_json(axis));
  }
  return json_text(json) + "\n";
}

void write_probe(const std::filesystem::path& path, const ProbeReport& report) {
  const std::string json = probe_json(report);
  AtomicFile file(path);
  file.write(std::as_bytes(std::span(json)));
  file.commit();
}

ProbeReport read_probe(const std::filesystem::path& file) {
  constexpr std::size_t kLargest = 1 << 24;  // bytes
  const Json json = parse_ordered_json(read_file(file, kLargest, "a probe"));
  return ProbeReader(file, json).report();
}

std::string probe_text(const ProbeReport& r) {
  std::string text = fmt::format(
      "{}, probed with at most {:.2g} N by palpate {}\n"
      "exchanges            {:.5g} a second; {} of {} missed; p50 {:.3f} ms, p99 "
      "{:.3f} "
      "ms, longest {:.3f} ms\n"
      "step of positions    {:.3g} mm\n",
      printable(r.device), r.force_max_n, printable(r.palpate), r.free_rate_hz,
      r.missed, r.exchanges, 1e3 * r.exchange_p50_s, 1e3 * r.exchange_p99_s,
      1e3 * r.exchange_max_s, 1e3 * r.resolution_m);
  if (r.by_hand) {
    const Eigen::Vector3d reach_mm = 1e3 * (r.highest_m - r.lowest_m);
    text += fmt::format("moved by hand over   {:.0f} x {:.0f} x {:.0f} mm\n",
                        reach_mm.x(), reach_mm.y(), reach_mm.z());
  }
  for (const ProbedAxis& axis : r.axis) {
    text += axis_text(axis);
  }
  return text;
}

std::string axes_not_found(const ProbeReport& report) {
  std::string names;
  for (const ProbedAxis& axis : report.axis) {
    if (!axis.failure.empty()) {
      names += (names.empty() ? "" : ", ") +
               std::string(kAxes[static_cast<std::size_t>(axis.axis)]);
    }
  }
  return names;
}

DeviceLimits probed_limits(const ProbeReport& report, const DeviceLimits& assumed) {
  DeviceLimits limits = assumed;
  double damping = std::numeric_limits<double>::infinity();
  double friction_n = damping;
  double delay_s = 0.0;
  // The worst axis counts: damping and friction less two standard deviations, the delay
  // with its resolution.
  for (const ProbedAxis& axis : report.axis) {
    if (axis.failure.empty()) {
      damping =
          std::min(damping, axis.damping_n_s_per_m - 2.0 * axis.damping_sd_n_s_per_m);
      friction_n = std::min(friction_n, axis.friction_n - 2.0 * axis.friction_sd_n);
      delay_s = std::max(delay_s, axis.delay_s + axis.delay_resolution_s);
    }
  }
  const bool any = std::isfinite(damping);
  // Axes that were not identified may be worse; they count as what was assumed.
  if (any && assumed.damping_n_s_per_m > 0.0 && !axes_not_found(report).empty()) {
    damping = std::min(damping, assumed.damping_n_s_per_m);
    friction_n = std::min(friction_n, assumed.coulomb_n);
    delay_s = std::max(delay_s, assumed.delay_s);
  }
  if (any) {
    limits.damping_n_s_per_m = damping > 0.0 ? damping : assumed.damping_n_s_per_m;
    limits.coulomb_n = std::max(0.0, friction_n);
    limits.delay_s = delay_s;
    limits.hold_s = std::max(assumed.hold_s, report.exchange_p50_s);
    limits.resolution_m = report.resolution_m;
  }
  return limits;
}

}  // namespace palpate
