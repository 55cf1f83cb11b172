#include "fitting/material/sweep_interpolation.h"

namespace palpate {

SweepInterpolation::SweepInterpolation(const ResponseSweep& sweep, std::size_t place) {
  const auto logarithms = [](const std::vector<double>& values) {
    std::vector<double> result;
    for (const double value : values) {
      result.push_back(std::log(value));
    }
    return result;
  };
  for (const SweepParameter& p : sweep.parameter) {
    grid_.push_back(logarithms(p.value));
  }
  grid_.push_back(logarithms(sweep.depth_m));
  stride_.assign(grid_.size(), 1);
  for (std::size_t j = grid_.size() - 1; j-- > 0;) {
    stride_[j] = stride_[j + 1] * grid_[j + 1].size();
  }
  const std::size_t count = sweep.combinations() * sweep.depth_m.size();
  const auto first = sweep.force_n.begin() + static_cast<std::ptrdiff_t>(place * count);
  log_force_ = logarithms({first, first + static_cast<std::ptrdiff_t>(count)});
}

}  // namespace palpate
