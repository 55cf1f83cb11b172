#include "fitting/insertion/needle_start.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "fitting/numerics/robust_statistics.h"
#include "formats/base/error.h"

namespace palpate {
namespace {

constexpr int kStartContacts = 60;  // places of z0 that are tried
constexpr std::array<double, 7> kStartExponents{1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5};
constexpr double kLowShare = 0.2;  // quantile of a layer's forces at its cutting force
constexpr double kLeastShare = 0.01;  // [-] of the force at the first rupture
constexpr std::size_t kPeakSamples = 3;

// b + c g(z): coefficients and squares left.
struct NeedleLine {
  double offset = 0.0, factor = 0.0, squares = 0.0;
};

NeedleLine straight_line(const std::vector<double>& g, const std::vector<double>& f) {
  const auto n = static_cast<double>(g.size());
  double sg = 0.0, sf = 0.0, sgg = 0.0, sgf = 0.0, sff = 0.0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    sg += g[i];
    sf += f[i];
    sgg += g[i] * g[i];
    sgf += g[i] * f[i];
    sff += f[i] * f[i];
  }
  const double spread = sgg - sg * sg / n, common = sgf - sg * sf / n;
  NeedleLine line;
  line.factor = spread > 0.0 ? common / spread : 0.0;
  line.offset = (sf - line.factor * sg) / n;
  line.squares = sff - sf * sf / n - line.factor * common;
  return line;
}

// Force less offset over inserted depth, of motion that meets friction alone.
double friction_per_length(const NeedlePath& path, const NeedleCurve& curve,
                           double plateau_n_per_m) {
  double products = 0.0, squares = 0.0;
  for (std::size_t p = 0; p < path.pass.size(); ++p) {
    const NeedlePass& pass = path.pass[p];
    for (std::size_t i = pass.in_begin; i < std::max(pass.in_end, pass.out_end); ++i) {
      const double l = path.depth_m[i] - curve.contact_m;
      const double turn = p > 0 ? path.pass[p - 1].turn_m : pass.turn_m;
      const bool out = path.motion[i] == NeedleMotion::kOut;
      const bool along = p > 0 && path.motion[i] == NeedleMotion::kIn;
      if ((out || along) && l > 0.0 &&
          l < (1.0 - kReversalShare) * (turn - curve.contact_m)) {
        products += (out ? -1.0 : 1.0) * l * (path.force_n[i] - curve.offset_n);
        squares += l * l;
      }
    }
  }
  return squares > 0.0 ? products / squares : plateau_n_per_m;
}

// [begin, end) of samples after rupture k, until the next one or the end of its pass.
std::pair<std::size_t, std::size_t> layer_samples(const NeedlePath& path,
                                                  const NeedleSwitches& switches,
                                                  std::size_t k) {
  const std::size_t begin = switches.ruptures[k].after;
  const auto pass =
      std::find_if(path.pass.begin(), path.pass.end(), [&](const NeedlePass& one) {
        return begin < one.in_end;
      });
  const std::size_t end = k + 1 < switches.ruptures.size()
                              ? switches.ruptures[k + 1].before + 1
                              : pass->in_end;
  return {begin, std::min(end, pass->in_end)};
}

double slope_after_ruptures(const NeedlePath& path, const NeedleSwitches& switches) {
  double best = 0.0;
  std::size_t most = 0;
  for (std::size_t k = 0; k < switches.ruptures.size(); ++k) {
    const auto samples = layer_samples(path, switches, k);
    const std::size_t begin = samples.first, end = samples.second;
    if (end > begin + std::max(most, kNeedlePartMin)) {
      most = end - begin;
      const auto cut = [&](const std::vector<double>& values) {
        return std::vector<double>(
            values.begin() + static_cast<std::ptrdiff_t>(begin),
            values.begin() + static_cast<std::ptrdiff_t>(begin + (end - begin) / 2));
      };
      best = std::max(0.0, straight_line(cut(path.depth_m), cut(path.force_n)).factor);
    }
  }
  return best;
}

double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(
                                       share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

NeedleCurve start_curve(const NeedlePath& path, const RuptureSamples& first) {
  std::vector<double> z, f;
  for (std::size_t i = path.pass.front().in_begin; i <= first.before; ++i) {
    if (path.motion[i] == NeedleMotion::kIn) {
      z.push_back(path.depth_m[i]);
      f.push_back(path.force_n[i]);
    }
  }
  if (z.size() < kNeedlePartMin) {
    throw InputError(
        fmt::format("{} samples before the first rupture, need at least {}", z.size(),
                    kNeedlePartMin));
  }
  NeedleCurve best;
  double least = std::numeric_limits<double>::infinity();
  const auto [low, high] = std::minmax_element(z.begin(), z.end());
  std::vector<double> g(z.size());
  for (int i = 0; i < kStartContacts; ++i) {
    const double contact = *low + (*high - *low) * i / kStartContacts;
    for (const double n : kStartExponents) {
      for (std::size_t j = 0; j < z.size(); ++j) {
        g[j] = std::pow(std::max(0.0, z[j] - contact), n);
      }
      const NeedleLine line = straight_line(g, f);
      if (line.factor > 0.0 && line.squares < least) {
        least = line.squares;
        best = {line.factor, n, contact, line.offset};
      }
    }
  }
  if (!(best.coefficient > 0.0)) {
    throw InputError("the force does not rise before the first rupture");
  }
  return best;
}

Eigen::VectorXd start_parameters(const NeedlePath& path, const NeedleSwitches& switches,
                                 const NeedleModel& model, const NeedleCurve& curve) {
  Eigen::VectorXd q = Eigen::VectorXd::Zero(model.parameters());
  const double reference = model.events().reference_m;
  const double peak = curve.coefficient * std::pow(reference, curve.exponent);
  const double phi =
      friction_per_length(path, curve, slope_after_ruptures(path, switches));
  q[NeedleModel::kLogForce] = std::log(peak);
  q[NeedleModel::kExponent] = curve.exponent;
  q[NeedleModel::kContact] = curve.contact_m;
  for (int file = 0; file < path.files; ++file) {
    q[model.offset(file)] = curve.offset_n;
  }
  for (int layer = 1; layer <= model.events().ruptures; ++layer) {
    const auto k = static_cast<std::size_t>(layer - 1);
    const auto [begin, end] = layer_samples(path, switches, k);
    const auto tip = [&](std::size_t i) {
      const double l = std::max(0.0, path.depth_m[i] - curve.contact_m);
      return path.force_n[i] - curve.offset_n - phi * l;
    };
    std::vector<double> forces;
    for (std::size_t i = begin; i < std::max(end, begin + 1); ++i) {
      forces.push_back(tip(i));
    }
    q[model.cutting(layer)] = std::max(kLeastShare * peak, quantile(forces, kLowShare));
    q[model.friction(layer)] = phi;
    if (layer < model.events().ruptures) {
      std::vector<double> last;
      for (std::size_t i = 0; i < kPeakSamples; ++i) {
        last.push_back(tip(switches.ruptures[k + 1].before - i));
      }
      const double at = std::max(median(last), q[model.cutting(layer)]);
      const double rise = std::pow(at / curve.coefficient, 1.0 / curve.exponent);
      q[model.boundary(layer)] =
          path.depth_m[switches.ruptures[k + 1].before] - curve.contact_m - rise;
    }
  }
  return q;
}

}  // namespace palpate
