#include "formats/report/axis_ticks.h"

#include <cmath>

#include <fmt/format.h>

namespace palpate {

double round_down(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  const double digits = value / power * (1.0 + 1e-12);
  return power * (digits >= 5.0 ? 5.0 : digits >= 2.0 ? 2.0 : 1.0);
}

std::vector<double> axis_ticks(double low, double high, int count) {
  // The step rounded down gives up to twice as many ticks as asked for; the next
  // round number, fewer.
  double step = round_down((high - low) / count);
  const double slack = 1e-9 * (high - low);
  if ((high - low) / step > 1.5 * count) {
    step = round_down(2.5 * step);
  }
  std::vector<double> ticks;
  for (double i = std::ceil((low - slack) / step); i * step <= high + slack; ++i) {
    ticks.push_back(i * step);
  }
  return ticks;
}

std::string short_number(double value) {
  return fmt::format("{:.3g}", std::abs(value) < 1e-12 ? 0.0 : value);
}

}  // namespace palpate
