#include "runtime/bench/bench_fidelity.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/base/error.h"
#include "formats/base/json_text.h"
#include "runtime/bench/bench_body.h"
#include "runtime/fast/fast_step.h"

namespace palpate {
namespace {

// The response that is poked.
struct PowerLaw {
  double a = 0.0;
  double p = 1.0;
  [[nodiscard]] SlowValue at(double x) const {
    if (!(x > 0.0)) {
      return {x, 0.0, 0.0, 0.0};
    }
    const double f = a * std::pow(x, p);
    return {x, f, p * f / x, f * x / (p + 1.0)};
  }
};

// One local model on the response: a force for each tick.
class ScalarPoke {
 public:
  ScalarPoke(LocalModel kind, const PowerLaw& law) : law_(law) { model_.kind = kind; }

  double tick(double x, double dt_s, bool slow) {
    advance(model_, ledger_, x, dt_s);
    if (slow) {
      update(model_, ledger_, law_.at(x));
    }
    return force_n(model_, x);
  }
  [[nodiscard]] double work_j() const { return ledger_.work_j; }

 private:
  PowerLaw law_;
  ScalarModel model_;
  PassivityLedger ledger_;
};

class ElementPoke {
 public:
  ElementPoke(const FidelityOptions& options, double exponent, LocalModel model)
      : state_(std::make_unique<FastState>()) {
    BenchBodyOptions body;
    body.cells = 1;
    body.exponent = exponent;
    body.force_n = options.force_n;
    body.depth_m = options.depth_m;
    element_ = make_bench_body(body).element.front();
    element_.active = true;
    state_->config.model = model;
    state_->config.force_max_n = 2.0 * options.force_n;
    state_->config.slew_max_n_per_s = std::numeric_limits<double>::infinity();
    at_ = {2e-3, 1e-3, 0.0};  // inside the element
    accept(*state_, element_);
  }

  double tick(double x, double dt_s, bool slow) {
    if (slow) {
      accept(*state_, element_);
    }
    at_.z() = -x;
    return step(*state_, {at_, 0}, dt_s).force_n.z();
  }
  [[nodiscard]] double work_j() const { return state_->ledger.work_j; }

 private:
  std::unique_ptr<FastState> state_;
  Element element_;
  Eigen::Vector3d at_;
};

template <typename Poke>
void measure(const FidelityOptions& o, const PowerLaw& law, Poke poke,
             FidelityRow& row) {
  const double dt = 1.0 / o.fast_hz;
  const long every = std::lround(o.fast_hz / o.slow_hz);
  const long ticks = std::lround(o.pokes / row.frequency_hz * o.fast_hz);
  double error2 = 0.0;
  double force2 = 0.0;
  for (long n = 0; n <= ticks; ++n) {
    const double t = static_cast<double>(n) * dt;
    const double s = std::sin(std::numbers::pi * row.frequency_hz * t);
    const double x = n == ticks ? 0.0 : o.depth_m * s * s;
    const double wanted = law.at(x).f_n;
    const double rendered = poke.tick(x, dt, n % every == 0);
    error2 += (rendered - wanted) * (rendered - wanted);
    force2 += wanted * wanted;
    row.lowest_energy_j = std::min(row.lowest_energy_j, poke.work_j());
  }
  row.rms_relative_error = std::sqrt(error2 / force2);
  row.net_energy_j = poke.work_j();
}

}  // namespace

FidelityRow run_poke(const FidelityOptions& options, double exponent,
                     double frequency_hz, LocalModel model) {
  const PowerLaw law{options.force_n / std::pow(options.depth_m, exponent), exponent};
  FidelityRow row;
  row.exponent = exponent;
  row.frequency_hz = frequency_hz;
  row.model = model;
  row.stored_energy_j = law.at(options.depth_m).energy_j;
  if (follows_surface(model)) {
    measure(options, law, ElementPoke(options, exponent, model), row);
  } else {
    measure(options, law, ScalarPoke(model, law), row);
  }
  return row;
}

std::vector<FidelityRow> run_fidelity(const FidelityOptions& options) {
  const double ticks = options.fast_hz / options.slow_hz;
  if (!(ticks >= 1.0) || std::abs(ticks - std::round(ticks)) > 1e-9) {
    throw InputError(
        fmt::format("bench fidelity: slow rate {} Hz, must divide the fast rate {} Hz",
                    options.slow_hz, options.fast_hz));
  }
  std::vector<FidelityRow> rows;
  for (const double exponent : options.exponents) {
    for (const double frequency : options.frequencies_hz) {
      for (const LocalModel model : kLocalModels) {
        rows.push_back(run_poke(options, exponent, frequency, model));
      }
    }
  }
  return rows;
}

std::string table_text(const std::vector<FidelityRow>& rows) {
  std::string text =
      fmt::format("{:>8} {:>6} {:<16} {:>12} {:>14} {:>14} {:>12}\n", "exponent", "Hz",
                  "model", "rms error", "net energy J", "lowest J", "stored J");
  for (const FidelityRow& row : rows) {
    text += fmt::format(
        "{:>8} {:>6} {:<16} {:>10.3f} % {:>14.3e} {:>14.3e} {:>12.3e}\n", row.exponent,
        row.frequency_hz, name(row.model), 100.0 * row.rms_relative_error,
        row.net_energy_j, row.lowest_energy_j, row.stored_energy_j);
  }
  return text;
}

std::string to_json(const std::vector<FidelityRow>& rows) {
  nlohmann::ordered_json json;
  json["rows"] = nlohmann::ordered_json::array();
  for (const FidelityRow& row : rows) {
    json["rows"].push_back({{"exponent", row.exponent},
                            {"frequency_hz", row.frequency_hz},
                            {"model", name(row.model)},
                            {"rms_relative_error", row.rms_relative_error},
                            {"net_energy_j", row.net_energy_j},
                            {"lowest_energy_j", row.lowest_energy_j},
                            {"stored_energy_j", row.stored_energy_j}});
  }
  return json_text(json);
}

}  // namespace palpate
