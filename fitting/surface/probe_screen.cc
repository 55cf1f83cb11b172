#include "fitting/surface/probe_screen.h"

#include <algorithm>
#include <cmath>

#include "fitting/numerics/robust_statistics.h"

namespace palpate {
namespace {

constexpr std::size_t kNeighbours = 8;
constexpr double kSuspectScore = 4.0;
constexpr double kShareMax = 0.2;

void use(std::span<FieldData> data, std::size_t point, bool wanted) {
  for (FieldData& set : data) {
    set.used[point] =
        wanted && std::isfinite(set.value[static_cast<Eigen::Index>(point)]) ? 1 : 0;
  }
}

std::vector<Eigen::Vector3d> positions_m(const FieldModel& model) {
  std::vector<Eigen::Vector3d> positions;
  for (const AttachedPoint& p : model.point()) {
    positions.push_back(position_m(model.mesh(), p));
  }
  return positions;
}

// Value minus the median of its nearest others; 0 where it has no value.
std::vector<double> local_residuals(const std::vector<Eigen::Vector3d>& position,
                                    const FieldData& data) {
  std::vector<double> residuals(position.size(), 0.0);
  for (std::size_t i = 0; i < position.size(); ++i) {
    std::vector<std::pair<double, double>> others;  // distance, value
    for (std::size_t j = 0; j < position.size(); ++j) {
      if (j != i && data.used[j] != 0) {
        others.emplace_back((position[j] - position[i]).norm(),
                            data.value[static_cast<Eigen::Index>(j)]);
      }
    }
    if (data.used[i] == 0 || others.empty()) {
      continue;
    }
    const auto count =
        static_cast<std::ptrdiff_t>(std::min(kNeighbours, others.size()));
    std::partial_sort(others.begin(), others.begin() + count, others.end());
    std::vector<double> near;
    for (std::ptrdiff_t k = 0; k < count; ++k) {
      near.push_back(others[static_cast<std::size_t>(k)].second);
    }
    residuals[i] = data.value[static_cast<Eigen::Index>(i)] - median(near);
  }
  return residuals;
}

// Each probe's largest distance from its neighbours, in robust standard deviations.
std::vector<double> local_scores(const FieldModel& model,
                                 std::span<const FieldData> data) {
  const auto position = positions_m(model);
  std::vector<double> score(position.size(), 0.0);
  for (const FieldData& set : data) {
    const std::vector<double> residual = local_residuals(position, set);
    const double scale = std::max(robust_standard_deviation(residual), 1e-6);
    for (std::size_t i = 0; i < score.size(); ++i) {
      score[i] = std::max(score[i], std::abs(residual[i]) / scale);
    }
  }
  return score;
}

// What the field says of every probe from the others, worst of all sets.
std::vector<BadProbe> field_scores(const FieldModel& model,
                                   const FieldParameters& parameters,
                                   std::span<const FieldData> data) {
  std::vector<BadProbe> result(model.point().size());
  for (std::size_t s = 0; s < data.size(); ++s) {
    const FieldPosterior posterior = model.posterior(parameters, data[s]);
    for (std::size_t i = 0; i < result.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      const double residual = posterior.left_out_residual[k];
      const double score = std::abs(residual) / posterior.left_out_sd[k];
      if (s == 0 || score > result[i].score) {
        const double value = data[s].value[k];
        result[i] = {i, s, value, value - residual, std::isnan(score) ? 0.0 : score};
      }
    }
  }
  return result;
}

// Marks the worst by local scores as not used.
std::vector<char> take_suspects(const FieldModel& model, std::span<FieldData> data,
                                std::size_t most) {
  const std::vector<double> score = local_scores(model, data);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < score.size(); ++i) {
    if (score[i] > kSuspectScore) {
      order.push_back(i);
    }
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return score[a] > score[b];
  });
  order.resize(std::min(order.size(), most));
  std::vector<char> out(score.size(), 0);
  for (const std::size_t i : order) {
    use(data, i, false);
    out[i] = 1;
  }
  return out;
}

// Brings suspects back that the field predicts. @return how many
std::size_t bring_back(const std::vector<BadProbe>& score, std::span<FieldData> data,
                       std::vector<char>& out) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (out[i] != 0 && score[i].score <= kBadProbeScore) {
      use(data, i, true);
      out[i] = 0;
      ++count;
    }
  }
  return count;
}

}  // namespace

ScreenedField screen_probes(const FieldModel& model, std::span<const FieldData> data,
                            const FieldParameters* near) {
  ScreenedField result{{data.begin(), data.end()}, {}, {}, {}};
  const auto most =
      static_cast<std::size_t>(kShareMax * static_cast<double>(model.point().size()));
  std::vector<char> out(model.point().size(), 0);
  for (std::size_t i = 0; i < out.size(); ++i) {
    use(result.data, i, true);
  }
  // 1. Probes unlike their neighbours are left out, and parameters are fitted without
  //    them.
  out = take_suspects(model, result.data, most);
  result.parameters = fit_field_parameters(model, result.data, near);
  std::vector<BadProbe> score =
      field_scores(model, result.parameters.parameters, result.data);
  // 2. Suspects that the field predicts come back.
  bool changed = bring_back(score, result.data, out) > 0;
  if (changed) {
    result.parameters =
        fit_field_parameters(model, result.data, &result.parameters.parameters);
    score = field_scores(model, result.parameters.parameters, result.data);
  }
  // 3. The worst probe is left out, as long as one is beyond the score.
  changed = false;
  while (true) {
    const BadProbe* worst = nullptr;
    std::size_t taken = 0;
    for (const BadProbe& probe : score) {
      taken += out[probe.point] != 0 ? 1 : 0;
      if (out[probe.point] == 0 && probe.score > kBadProbeScore &&
          (worst == nullptr || probe.score > worst->score)) {
        worst = &probe;
      }
    }
    if (worst == nullptr || taken >= most) {
      break;
    }
    use(result.data, worst->point, false);
    out[worst->point] = 1;
    changed = true;
    score = field_scores(model, result.parameters.parameters, result.data);
  }
  // 4. Parameters without the bad probes.
  if (changed) {
    result.parameters =
        fit_field_parameters(model, result.data, &result.parameters.parameters);
    score = field_scores(model, result.parameters.parameters, result.data);
  }
  for (const BadProbe& probe : score) {
    if (out[probe.point] != 0) {
      result.bad.push_back(probe);
    } else if (probe.score > kBadProbeScore) {
      result.undecided.push_back(probe.point);
    }
  }
  std::sort(result.bad.begin(), result.bad.end(),
            [](const BadProbe& a, const BadProbe& b) {
              return a.score > b.score;
            });
  return result;
}

}  // namespace palpate
