#include "precompute/press/ratio_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "formats/base/reproducible.h"

namespace palpate {
namespace {

// Contact radii that normals a radian apart count as, or stiffnesses e times apart.
constexpr double kAlikeRadii = 4.0;
// Energy that laws add which counts as a stiffness e times as large.
constexpr double kAlikeEnergy = 0.25;
// [rad] Lean of a linear force below which its direction along the surface is the
// mesh's.
constexpr double kLeastLean = 0.003;

// Lengths over which ratios of homogeneous bodies are alike: contact radii in space,
// of normals, of logarithms of stiffness, of nonlinearity. Chosen on a gel cylinder and
// an organ of gel, every node solved.
constexpr std::array kUsualLengths{80.0, 1.0, 1.5, 1.0};
// What lengths apart from those cost, times the square of the ratio's logarithm, in the
// logarithm of probability: more would fix them, less follows a dozen samples anywhere.
constexpr double kUnusual = 4.0;
constexpr int kSweeps = 3;
// Left-out ratios that agree better do so by chance.
constexpr double kLeastError = 1e-3;

// Nine tenths of the squares, the least, have this mean where values are normal, over
// that of all. The others may be of presses that snapped, and count around themselves.
constexpr double kOrdinary = 0.9;
constexpr double kMeanOfOrdinary = 0.623;
constexpr std::size_t kAround = 6;
constexpr double kUnlikeError = 1.0;

// The variance of values that are normal but for a tenth, from their squares.
double ordinary_variance(const Eigen::VectorXd& square) {
  std::vector<double> ordered(square.begin(), square.end());
  std::sort(ordered.begin(), ordered.end());
  const auto kept = static_cast<std::size_t>(
      std::ceil(kOrdinary * static_cast<double>(ordered.size())));
  double sum = 0.0;
  for (std::size_t i = 0; i < kept; ++i) {
    sum += ordered[i];
  }
  return sum / (kMeanOfOrdinary * static_cast<double>(kept));
}

}  // namespace

RatioField::Place RatioField::place_of(std::int32_t vertex, const Indentation& linear) {
  // Of the secant at the path's end.
  const double force_n =
      std::max(linear.sample.back().force_n.norm(), std::numeric_limits<double>::min());
  const double past_touch_m =
      linear.sample.back().penetration_m - linear.sample.front().penetration_m;
  Eigen::Vector3d mean_n = Eigen::Vector3d::Zero();
  for (std::size_t k = 1; k < linear.sample.size(); ++k) {
    const double step_m =
        linear.sample[k].penetration_m - linear.sample[k - 1].penetration_m;
    // Mean force over the path, by the trapezoidal rule.
    mean_n += 0.5 * step_m / past_touch_m *
              (linear.sample[k - 1].force_n + linear.sample[k].force_n);
  }
  return {vertex, reproducible::log(force_n / past_touch_m), linear.nonlinearity,
          mean_n};
}

void RatioField::add(std::int32_t vertex, const Indentation& linear,
                     std::optional<PathRatio> ratio) {
  ratios_ += ratio ? 1 : 0;
  Eigen::MatrixX3d direction(static_cast<Eigen::Index>(linear.sample.size()) - 1, 3);
  for (Eigen::Index k = 0; k < direction.rows(); ++k) {
    direction.row(k) =
        linear.sample[static_cast<std::size_t>(k) + 1].force_n.normalized().transpose();
  }
  known_.push_back({place_of(vertex, linear), std::move(ratio), std::move(direction)});
}

double RatioField::unlikeness(const Place& a, const Place& b) const {
  const double turned = (normal_.row(a.vertex) - normal_.row(b.vertex)).norm();
  const double stiffer = a.log_stiffness - b.log_stiffness;
  const double bent = (a.nonlinearity - b.nonlinearity) / kAlikeEnergy;
  return std::hypot(turned, stiffer, bent);
}

double RatioField::distance_m(const Place& a, const Place& b) const {
  const double away =
      (surface_.position_m.row(a.vertex) - surface_.position_m.row(b.vertex)).norm();
  return std::hypot(away, kAlikeRadii * contact_m_ * unlikeness(a, b));
}

Eigen::Vector<double, RatioField::kCoordinates> RatioField::coordinates(
    const Place& p) const {
  Eigen::Vector<double, kCoordinates> x;
  x << surface_.position_m.row(p.vertex).transpose() / contact_m_,
      normal_.row(p.vertex).transpose(), p.log_stiffness, p.nonlinearity;
  return x;
}

Eigen::Matrix3d RatioField::frame(const Place& p) const {
  const Eigen::Vector3d n = normal_.row(p.vertex).transpose();
  const Eigen::Vector3d u = p.force_n.normalized();
  const Eigen::Vector3d lean = u - u.dot(n) * n;
  const Eigen::Vector3d c = lean / std::hypot(lean.norm(), kLeastLean);
  Eigen::Matrix3d axes;
  axes << n, c, n.cross(c);
  return axes;
}

RatioModel::RatioModel(const RatioField& field)
    : field_(field), lengths_(kUsualLengths) {
  Eigen::Index depths = 0;
  for (std::size_t i = 0; i < field.known().size(); ++i) {
    if (const auto& ratio = field.known()[i].ratio) {
      with_ratio_.push_back(i);
      depths = std::max(depths, ratio->force.size());
    }
  }
  const auto n = static_cast<Eigen::Index>(with_ratio_.size());
  // A row of values has k logarithms of the force ratio, k turns about each axis of
  // frame(), and the share of near-singular load paths. k counts the depths.
  value_.resize(n, 4 * depths + 1);
  weight_ = Eigen::MatrixXd::Zero(n, depths);
  for (Eigen::Index i = 0; i < n; ++i) {
    const RatioField::Known& known =
        field.known()[with_ratio_[static_cast<std::size_t>(i)]];
    const PathRatio& ratio = *known.ratio;
    const Eigen::Matrix3d frame = field.frame(known.place);
    for (Eigen::Index k = 0; k < depths; ++k) {
      // A longer path goes on where shorter ones end.
      const Eigen::Index at = std::min(k, ratio.force.size() - 1);
      value_(i, k) = reproducible::log(ratio.force[at]);
      const Eigen::RowVector3d turn = ratio.turn.row(at) * frame;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        value_(i, (axis + 1) * depths + k) = turn[axis];
      }
    }
    value_(i, 4 * depths) = ratio.hard_share;
    weight_.row(i).head(ratio.weight.size()) = ratio.weight.transpose();
  }
  if (n > 1) {
    lengths_ = best_lengths();
  }
  if (n > 0) {
    kriging_ = kriging(lengths_);
  }
  if (n > 1) {
    left_out_ = left_out(*kriging_);
    // Squares over the variance that kriging expects: their scale is the field's
    // variance.
    roughness_.each = left_out_.error.array().square() / left_out_.variance.array();
    roughness_.ordinary = ordinary_variance(roughness_.each);
  }
}

Eigen::VectorXd RatioModel::scaled(const RatioField::Place& place,
                                   const Lengths& lengths) const {
  Eigen::VectorXd x = field_.coordinates(place);
  x.head<3>() /= lengths[0];
  x.segment<3>(3) /= lengths[1];
  x[6] /= lengths[2];
  x[7] /= lengths[3];
  return x;
}

Kriging RatioModel::kriging(const Lengths& lengths) const {
  Eigen::MatrixXd place(value_.rows(), RatioField::kCoordinates);
  for (Eigen::Index i = 0; i < place.rows(); ++i) {
    const std::size_t known = with_ratio_[static_cast<std::size_t>(i)];
    place.row(i) = scaled(field_.known()[known].place, lengths).transpose();
  }
  return Kriging(std::move(place));
}

RatioModel::LeftOut RatioModel::left_out(const Kriging& kriging) const {
  const Eigen::Index depths = weight_.cols();
  const Eigen::MatrixXd off = kriging.left_out(value_.leftCols(4 * depths));
  LeftOut result{.error = Eigen::VectorXd::Zero(off.rows()),
                 .variance = kriging.left_out_variance()};
  for (Eigen::Index i = 0; i < off.rows(); ++i) {
    const RatioField::Known& known =
        field_.known()[with_ratio_[static_cast<std::size_t>(i)]];
    const PathRatio predicted =
        ratio_of((value_.leftCols(4 * depths) - off).row(i).transpose(), known.place);
    // off = ln(true ratio) - ln(predicted ratio): r - 1 = exp(-off) - 1.
    for (Eigen::Index k = 0; k < known.ratio->force.size(); ++k) {
      // |r e' - e|^2 = (r - 1)^2 + r |e' - e|^2, r the predicted force over the true
      // one, e and e' their directions.
      const double off_by = reproducible::expm1(-off(i, k));
      const Eigen::RowVector3d linear =
          known.direction.row(std::min(k, known.direction.rows() - 1));
      const double turned = ((linear + predicted.turn.row(k)).normalized() -
                             (linear + known.ratio->turn.row(k)).normalized())
                                .norm();
      result.error[i] = std::max(
          result.error[i],
          weight_(i, k) * std::hypot(off_by, std::sqrt(1.0 + off_by) * turned));
    }
  }
  return result;
}

// Minus the logarithm of the probability that each known ratio has beside the others,
// whatever the field's spread is, and of the lengths.
double RatioModel::improbability(const Lengths& lengths) const {
  // sum_i ln(v_i)/2 + n/2 ln(mean of e_i^2 / v_i), e_i and v_i error and variance of
  // the left-out ratio i (Sundararajan, Keerthi 2001). The mean is the field's own
  // variance.
  const LeftOut beside = left_out(kriging(lengths));
  double sum = 0.0;
  double squares = 0.0;
  for (Eigen::Index i = 0; i < beside.error.size(); ++i) {
    const double error = std::max(beside.error[i], kLeastError);
    sum += 0.5 * reproducible::log(beside.variance[i]);
    squares += error * error / beside.variance[i];
  }
  const auto n = static_cast<double>(beside.error.size());
  sum += 0.5 * n * reproducible::log(squares / n);
  for (std::size_t l = 0; l < lengths.size(); ++l) {
    const double unusual = reproducible::log(lengths[l] / kUsualLengths[l]);
    sum += kUnusual * unusual * unusual;
  }
  return sum;
}

// Each in turn is doubled or halved as long as that is better.
RatioModel::Lengths RatioModel::best_lengths() const {
  Lengths best = kUsualLengths;
  double least = improbability(best);
  const auto improves = [&](std::size_t l, double factor) {
    Lengths trial = best;
    trial[l] *= factor;
    const double score = improbability(trial);
    if (!(score < least)) {
      return false;
    }
    best = trial;
    least = score;
    return true;
  };
  // Descent along the coordinates: at most kSweeps sweeps, or until none moves.
  bool moved = true;
  for (int sweep = 0; sweep < kSweeps && moved; ++sweep) {
    moved = false;
    for (std::size_t l = 0; l < best.size(); ++l) {
      for (const double factor : {2.0, 0.5}) {
        while (improves(l, factor)) {
          moved = true;
        }
      }
    }
  }
  return best;
}

// @param value a row of value_, with or without the hard share.
PathRatio RatioModel::ratio_of(const Eigen::VectorXd& value,
                               const RatioField::Place& place) const {
  const Eigen::Index depths = weight_.cols();
  PathRatio ratio;
  ratio.force.resize(depths);
  if (value.size() > 4 * depths) {
    ratio.hard_share = std::clamp(value[4 * depths], 0.0, 1.0);
  }
  for (Eigen::Index k = 0; k < depths; ++k) {
    ratio.force[k] = reproducible::exp(value[k]);
  }
  const Eigen::Map<const Eigen::MatrixX3d> turn(value.data() + depths, depths, 3);
  ratio.turn = turn * field_.frame(place).transpose();
  return ratio;
}

PathRatio RatioModel::at(std::int32_t vertex, const Indentation& linear) const {
  const RatioField::Place place = RatioField::place_of(vertex, linear);
  return ratio_of(value_.transpose() * kriging_->at(scaled(place, lengths_)).weight,
                  place);
}

PathRatio RatioModel::from_others(std::int32_t vertex,
                                  const Indentation& linear) const {
  for (std::size_t i = 0; i < with_ratio_.size(); ++i) {
    if (field_.known()[with_ratio_[i]].place.vertex == vertex) {
      const auto row = static_cast<Eigen::Index>(i);
      return ratio_of((value_ - kriging_->left_out(value_)).row(row).transpose(),
                      RatioField::place_of(vertex, linear));
    }
  }
  return at(vertex, linear);
}

// Means over the nearest known vertices, weighted by inverse squares of distance.
RatioModel::Around RatioModel::around(const RatioField::Place& place) const {
  std::vector<std::pair<double, std::size_t>> nearest;  // distance, in field_.known()
  for (std::size_t i = 0; i < field_.known().size(); ++i) {
    nearest.emplace_back(field_.distance_m(place, field_.known()[i].place), i);
  }
  const std::size_t kept = std::min(kAround, nearest.size());
  std::partial_sort(nearest.begin(),
                    nearest.begin() + static_cast<std::ptrdiff_t>(kept), nearest.end());
  nearest.resize(kept);
  Around mean;
  double sum = 0.0;
  for (const auto& [distance_m, known] : nearest) {
    const double weight = 1.0 / (distance_m * distance_m + 1e-300);
    sum += weight;
    const auto at = std::lower_bound(with_ratio_.begin(), with_ratio_.end(), known);
    if (at != with_ratio_.end() && *at == known) {
      mean.roughness += weight * roughness_.each[at - with_ratio_.begin()];
    } else {
      mean.unlike += weight;
    }
  }
  return {mean.roughness / sum, mean.unlike / sum};
}

double RatioModel::error_at(std::int32_t vertex, const Indentation& linear) const {
  if (with_ratio_.size() < 2) {
    return kUnlikeError;
  }
  const RatioField::Place place = RatioField::place_of(vertex, linear);
  const Around near = around(place);
  // Kriging's variance times the field's: sqrt is the standard deviation of the error.
  const double variance = kriging_->at(scaled(place, lengths_)).variance *
                          std::max(near.roughness, roughness_.ordinary);
  return std::hypot(kExpectedDeviations * std::sqrt(variance),
                    kUnlikeError * std::sqrt(near.unlike));
}

std::vector<double> RatioModel::left_out_errors() const {
  std::vector<double> errors(field_.known().size(), kUnlikeError);
  for (Eigen::Index i = 0; i < left_out_.error.size(); ++i) {
    errors[with_ratio_[static_cast<std::size_t>(i)]] = left_out_.error[i];
  }
  return errors;
}

}  // namespace palpate
