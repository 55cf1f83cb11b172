#include "runtime/bench/bench_table1.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "runtime/bench/rendered_wall.h"

namespace palpate {
namespace {

constexpr double kSearchFrom = 10.0;    // [N/m]
constexpr double kSearchFactor = 1.05;  // coarse raise of k
constexpr double kStillM = 1e-7;        // a range below this is at rest

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  void include(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  [[nodiscard]] double width() const { return high - low; }
};

// The device leaning on the wall through a local model.
class Experiment {
 public:
  Experiment(const Table1Options& options, LocalModel model, double slow_hz, double k)
      : options_(options.device),
        preload_(options.preload_n),
        resolution_(options.resolution_m),
        tick_(1.0 / options.fast_hz),
        every_(std::lround(options.fast_hz / slow_hz)),
        device_(options.device, tick_),
        late_(static_cast<std::size_t>(std::ceil(options.delay_s / tick_ - 1e-9)), 0.0),
        wall_(model, options.wall, k, options.relaxation) {}

  void settle(double hand_n_s_per_m, double seconds) {
    VirtualDeviceOptions held = options_;
    held.damping_n_s_per_m += hand_n_s_per_m;
    device_ = VirtualDevice(held, tick_);
    (void)run(seconds);
    const double x = device_.position_m();
    device_ = VirtualDevice(options_, tick_);
    device_.set_position_m(x);
  }

  [[nodiscard]] Range run(double seconds) {
    Range range;
    for (long n = std::lround(seconds / tick_); n > 0; --n, ++count_) {
      const double x = device_.position_m();
      range.include(x);
      const double force = wall_.tick(measured(x), tick_, count_ % every_ == 0);
      device_.step(preload_ - delayed(force));
    }
    return range;
  }

  VirtualDevice& device() { return device_; }

 private:
  [[nodiscard]] double measured(double x) const {
    return resolution_ > 0.0 ? resolution_ * std::round(x / resolution_) : x;
  }

  // What was commanded as many ticks ago as the delay has.
  double delayed(double force) {
    if (!late_.empty()) {
      std::swap(force, late_[static_cast<std::size_t>(count_) % late_.size()]);
    }
    return force;
  }

  VirtualDeviceOptions options_;
  double preload_;
  double resolution_;
  double tick_;
  long every_;
  long count_ = 0;
  VirtualDevice device_;
  std::vector<double> late_;
  RenderedWall wall_;
};

void require_relaxation(const WallRelaxation& relaxation) {
  const auto& [share, time_s] = relaxation;
  if (share.size() != time_s.size() || share.size() > kMemoryTerms) {
    throw InputError(fmt::format(
        "bench table1: {} shares that relax and {} times, must be as many, {} at most",
        share.size(), time_s.size(), kMemoryTerms));
  }
  const double sum = std::accumulate(share.begin(), share.end(), 0.0);
  if (!(sum <= 1.0)) {
    throw InputError(fmt::format(
        "bench table1: shares that relax sum to {:.4g}, must sum to at most 1", sum));
  }
  if (std::adjacent_find(time_s.begin(), time_s.end(), std::greater_equal<>()) !=
      time_s.end()) {
    throw InputError(fmt::format("bench table1: times are {} s, must rise",
                                 fmt::join(time_s, ", ")));
  }
}

}  // namespace

bool wall_is_stable(const Table1Options& options, LocalModel model, double slow_hz,
                    double stiffness_n_per_m) {
  Experiment experiment(options, model, slow_hz, stiffness_n_per_m);
  experiment.settle(options.hand_n_s_per_m, options.settle_s);
  experiment.device().kick(options.kick_m_per_s);
  const double quarter = options.watch_s / 4.0;
  const double first = experiment.run(quarter).width();
  (void)experiment.run(2.0 * quarter);
  const double last = experiment.run(quarter).width();
  // A measured position that is one of two neighbours is at rest.
  return last <= std::max(kStillM, 2.0 * options.resolution_m) || last < first;
}

double largest_stable_stiffness(const Table1Options& options, LocalModel model,
                                double slow_hz) {
  double stable = kSearchFrom;
  double unstable = stable;
  while (wall_is_stable(options, model, slow_hz, unstable)) {
    stable = unstable;
    unstable *= kSearchFactor;
    if (unstable > options.stiffness_max) {
      return stable;
    }
  }
  while (unstable - stable > options.tolerance * stable) {
    const double middle = 0.5 * (stable + unstable);
    (wall_is_stable(options, model, slow_hz, middle) ? stable : unstable) = middle;
  }
  return stable;
}

Table1Report run_table1(const Table1Options& options) {
  for (const double rate : options.rates_hz) {
    // The slow process runs in whole ticks of the fast one.
    const double ticks = options.fast_hz / rate;
    if (!(rate > 0.0) || std::abs(ticks - std::round(ticks)) > 1e-9 || ticks < 1.0) {
      throw InputError(
          fmt::format("bench table1: slow rate {} Hz, must divide the fast rate {} Hz",
                      rate, options.fast_hz));
    }
  }
  require_relaxation(options.relaxation);
  Table1Report report{
      options.rates_hz,
      {},
      options.preload_n,
      fmt::format("{} wall{}", name(options.wall),
                  options.relaxation.share.empty() ? "" : " that relaxes")};
  for (const LocalModel model : kLocalModels) {
    Table1Column column{model, {}};
    for (const double rate : options.rates_hz) {
      column.stiffness_n_per_m.push_back(
          largest_stable_stiffness(options, model, rate));
    }
    report.columns.push_back(column);
  }
  return report;
}

namespace {

// The paper's value at a rate; NaN for a rate that it does not have.
double paper_value(const PaperColumn& column, double rate_hz) {
  for (std::size_t i = 0; i < kPaperRatesHz.size(); ++i) {
    if (kPaperRatesHz[i] == rate_hz) {
      return column.stiffness_n_per_m[i];
    }
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

std::string table_text(const Table1Report& report) {
  std::string text = fmt::format(
      "Largest stable stiffness [N/m] of a {} on the virtual PenCat under {} N, fast "
      "rate "
      "2000 Hz\n",
      report.wall, report.preload_n);
  text += fmt::format("{:>8}", "rate Hz");
  for (const Table1Column& column : report.columns) {
    text += fmt::format(" {:>16}", name(column.model));
  }
  text += " | paper:";
  for (const PaperColumn& column : kPaperTable1) {
    text += fmt::format(" {:>20}", column.name);
  }
  text += '\n';
  for (std::size_t i = 0; i < report.rates_hz.size(); ++i) {
    text += fmt::format("{:>8}", report.rates_hz[i]);
    for (const Table1Column& column : report.columns) {
      text += fmt::format(" {:>16.1f}", column.stiffness_n_per_m[i]);
    }
    text += " |       ";
    for (const PaperColumn& column : kPaperTable1) {
      text += fmt::format(" {:>20}", paper_value(column, report.rates_hz[i]));
    }
    text += '\n';
  }
  return text;
}

std::string table_csv(const Table1Report& report) {
  std::string text = "rate_hz";
  for (const Table1Column& column : report.columns) {
    text += fmt::format(",{}", name(column.model));
  }
  for (const PaperColumn& column : kPaperTable1) {
    text += fmt::format(",paper-{}", column.name);
  }
  text += '\n';
  for (std::size_t i = 0; i < report.rates_hz.size(); ++i) {
    text += fmt::format("{}", report.rates_hz[i]);
    for (const Table1Column& column : report.columns) {
      text += fmt::format(",{}", column.stiffness_n_per_m[i]);
    }
    for (const PaperColumn& column : kPaperTable1) {
      text += fmt::format(",{}", paper_value(column, report.rates_hz[i]));
    }
    text += '\n';
  }
  return text;
}

std::string to_json(const Table1Report& report) {
  nlohmann::ordered_json json;
  json["wall"] = report.wall;
  json["preload_n"] = report.preload_n;
  json["rates_hz"] = report.rates_hz;
  for (const Table1Column& column : report.columns) {
    json["columns"][std::string(name(column.model))] = column.stiffness_n_per_m;
  }
  for (const PaperColumn& column : kPaperTable1) {
    nlohmann::ordered_json& values = json["paper"][column.name];
    for (const double rate : report.rates_hz) {
      values.push_back(paper_value(column, rate));  // NaN is written as null
    }
  }
  return json_text(json);
}

}  // namespace palpate
