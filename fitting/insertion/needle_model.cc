#include "fitting/insertion/needle_model.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "formats/base/error.h"

namespace palpate {

NeedleModel::NeedleModel(NeedleEvents events) : events_(std::move(events)) {
  if (parameters() > kNeedleParametersMax) {
    throw InputError(fmt::format(
        "{} ruptures in {} files: needs {} parameters, has room for {}",
        events_.ruptures, events_.files, parameters(), kNeedleParametersMax));
  }
}

NeedleTerm NeedleModel::constant(double value) const {
  NeedleTerm term;
  term.value = value;
  term.slope.setZero(parameters());
  return term;
}

NeedleTerm NeedleModel::turn_depth(const Eigen::VectorXd& q, std::size_t pass) const {
  const int j = turn(static_cast<int>(pass));
  NeedleTerm depth = constant(events_.turn_m[pass] + q[j]);
  depth.slope[j] = 1.0;
  return depth;
}

double NeedleModel::coefficient(const Eigen::VectorXd& q) const {
  return std::exp(q[kLogForce] - q[kExponent] * std::log(events_.reference_m));
}

// e = r (C / P)^(1/n), P the force at the reference deflection r.
NeedleTerm NeedleModel::cutting_deflection(const Eigen::VectorXd& q, int layer) const {
  NeedleTerm e = constant(0.0);
  const double n = q[kExponent], cut = q[cutting(layer)];
  const double log_ratio = std::log(cut) - q[kLogForce];
  e.value = events_.reference_m * std::exp(log_ratio / n);
  e.slope[kLogForce] = -e.value / n;
  e.slope[kExponent] = -e.value * log_ratio / (n * n);
  e.slope[cutting(layer)] = e.value / (n * cut);
  return e;
}

NeedleTerm NeedleModel::channel(const Eigen::VectorXd& q, const NeedleTerm& depth,
                                int ruptures, const NeedleTerm& before) const {
  if (ruptures == 0) {
    return before;
  }
  const NeedleTerm e = cutting_deflection(q, ruptures);
  NeedleTerm opened = constant(depth.value - q[kContact] - e.value);
  opened.slope = depth.slope - e.slope;
  opened.slope[kContact] -= 1.0;
  if (ruptures < events_.ruptures && opened.value > q[boundary(ruptures)]) {
    opened = constant(q[boundary(ruptures)]);
    opened.slope[boundary(ruptures)] = 1.0;
  }
  return opened.value > before.value ? opened : before;
}

std::vector<NeedleTerm> NeedleModel::channels(const Eigen::VectorXd& q) const {
  std::vector<NeedleTerm> ends;
  NeedleTerm last = constant(0.0);
  for (std::size_t pass = 0; pass < events_.turn_m.size(); ++pass) {
    last = channel(q, turn_depth(q, pass), events_.turn_ruptures[pass], last);
    ends.push_back(last);
  }
  return ends;
}

NeedleTerm NeedleModel::tip_force(const Eigen::VectorXd& q, double depth_m,
                                  const NeedleTerm& channel) const {
  NeedleTerm f = constant(0.0);
  const double e = depth_m - q[kContact] - channel.value;
  if (!(e > 0.0)) {
    return f;
  }
  const double log_e = std::log(e / events_.reference_m);
  f.value = std::exp(q[kLogForce] + q[kExponent] * log_e);
  const double stiffness = q[kExponent] * f.value / e;  // df/de [N/m]
  f.slope = -stiffness * channel.slope;
  f.slope[kContact] -= stiffness;
  f.slope[kLogForce] += f.value;
  f.slope[kExponent] += f.value * log_e;
  return f;
}

NeedleTerm NeedleModel::shaft_friction(const Eigen::VectorXd& q,
                                       const NeedleTerm& depth,
                                       const NeedleTerm& channel) const {
  NeedleTerm sum = constant(0.0);
  NeedleTerm inserted = channel;
  if (const double l = depth.value - q[kContact]; l < channel.value) {
    inserted = depth;
    inserted.value = l;
    inserted.slope[kContact] -= 1.0;
  }
  double begin = 0.0;
  for (int layer = 1; layer <= events_.ruptures && begin < inserted.value; ++layer) {
    const bool last = layer == events_.ruptures || q[boundary(layer)] >= inserted.value;
    const double end = last ? inserted.value : std::max(begin, q[boundary(layer)]);
    const double phi = q[friction(layer)];
    sum.value += phi * (end - begin);
    sum.slope[friction(layer)] += end - begin;
    if (last) {
      sum.slope += phi * inserted.slope;
    } else {
      sum.slope[boundary(layer)] += phi;
    }
    if (layer > 1) {
      sum.slope[boundary(layer - 1)] -= phi;
    }
    begin = end;
    if (last) {
      break;
    }
  }
  return sum;
}

NeedleTerm NeedleModel::force(const Eigen::VectorXd& q, const NeedleSample& sample,
                              const std::vector<NeedleTerm>& ends) const {
  const auto pass = static_cast<std::size_t>(sample.pass);
  const bool inwards = sample.shaft == ShaftState::kInwards;
  const NeedleTerm before = pass > 0 ? ends[pass - 1] : constant(0.0);
  const NeedleTerm depth = constant(sample.depth_m);
  const NeedleTerm opened =
      inwards ? channel(q, depth, sample.ruptures, before) : ends[pass];
  NeedleTerm force = tip_force(q, sample.depth_m, opened);
  const bool sticks = sample.shaft == ShaftState::kSticks;
  const NeedleTerm turn = turn_depth(q, pass);
  const NeedleTerm shaft = shaft_friction(q, sticks ? turn : depth, opened);
  const double sign = inwards || sticks ? 1.0 : -1.0;
  force.value += sign * shaft.value;
  force.slope += sign * shaft.slope;
  if (sticks) {
    force.value -= q[kPresliding] * (turn.value - sample.depth_m);
    force.slope[kPresliding] -= turn.value - sample.depth_m;
    force.slope -= q[kPresliding] * turn.slope;
  }
  force.value += q[offset(sample.file)] + q[drift(sample.file)] * sample.clock;
  force.slope[offset(sample.file)] += 1.0;
  force.slope[drift(sample.file)] += sample.clock;
  return force;
}

void NeedleModel::evaluate(const std::vector<NeedleSample>& samples,
                           const std::vector<double>& force_n, const Eigen::VectorXd& q,
                           Eigen::Ref<Eigen::VectorXd> residual,
                           RowMajorMatrix* jacobian) const {
  const std::vector<NeedleTerm> ends = channels(q);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const NeedleTerm modelled = force(q, samples[i], ends);
    const auto row = static_cast<Eigen::Index>(i);
    residual[row] = modelled.value - force_n[i];
    if (jacobian != nullptr) {
      jacobian->row(row) = modelled.slope.transpose();
    }
  }
}

}  // namespace palpate
