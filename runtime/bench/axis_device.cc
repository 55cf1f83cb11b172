#include "runtime/bench/axis_device.h"

#include <cmath>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {
namespace {

// exp(A) by Taylor's series of A / 2^s, squared s times; |A| / 2^s below 1/2.
Eigen::Matrix4d matrix_exponential(const Eigen::Matrix4d& A) {
  const double norm = A.cwiseAbs().rowwise().sum().maxCoeff();
  const int halvings = std::max(0, static_cast<int>(std::ceil(std::log2(norm))) + 1);
  const Eigen::Matrix4d scaled = A / std::pow(2.0, halvings);
  Eigen::Matrix4d term = Eigen::Matrix4d::Identity();
  Eigen::Matrix4d sum = term;
  for (int n = 1; n <= 16; ++n) {
    term = term * scaled / n;
    sum += term;
  }
  for (int i = 0; i < halvings; ++i) {
    sum = (sum * sum).eval();
  }
  return sum;
}

void check_device(const VirtualDeviceOptions& o, double tick_s) {
  const auto refuse = [](const char* what, double value, const char* allowed) {
    throw InputError(
        fmt::format("virtual device: {} is {}, must be {}", what, value, allowed));
  };
  if (!(o.mass_kg > 0.0)) {
    refuse("mass [kg]", o.mass_kg, "positive");
  }
  if (!(o.damping_n_s_per_m >= 0.0)) {
    refuse("damping [N s/m]", o.damping_n_s_per_m, "not negative");
  }
  if (!(o.load_n_per_m >= 0.0)) {
    refuse("load spring [N/m]", o.load_n_per_m, "not negative");
  }
  if (!(o.load_damping_n_s_per_m > 0.0)) {
    refuse("load damping [N s/m]", o.load_damping_n_s_per_m, "positive");
  }
  if (!(tick_s > 0.0)) {
    refuse("tick [s]", tick_s, "positive");
  }
}

}  // namespace

VirtualDevice::VirtualDevice(const VirtualDeviceOptions& o, double tick_s) {
  check_device(o, tick_s);
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();  // of (x, v, m, F), F' = 0
  A(0, 1) = 1.0;
  A(1, 1) = -o.damping_n_s_per_m / o.mass_kg;
  A(1, 2) = -1.0 / o.mass_kg;
  A(1, 3) = 1.0 / o.mass_kg;
  A(2, 1) = o.load_n_per_m;
  A(2, 2) = -o.load_n_per_m / o.load_damping_n_s_per_m;
  const Eigen::Matrix4d exponential = matrix_exponential(A * tick_s);
  transition_ = exponential.topLeftCorner<3, 3>();
  input_ = exponential.topRightCorner<3, 1>();
}

}  // namespace palpate
