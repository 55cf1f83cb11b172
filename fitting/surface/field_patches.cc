#include "fitting/surface/field_patches.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fitting/numerics/robust_statistics.h"
#include "fitting/surface/probe_screen.h"

namespace palpate {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Sums {
  double count = 0.0, covered = 0.0, squares = 0.0;
};

void predict(const FieldModel& model, std::span<const FieldData> data,
             const std::vector<std::size_t>& patch, const FieldParameters& near,
             Sums& sums) {
  // The patch is hidden from screening and parameters, and then asked for its
  // residuals.
  std::vector<FieldData> others(data.begin(), data.end());
  for (FieldData& set : others) {
    for (const std::size_t i : patch) {
      set.value[static_cast<Eigen::Index>(i)] = kNaN;
    }
  }
  const ScreenedField fit = screen_probes(model, others, &near);
  const auto probable = probable_parameters(model, fit.data, fit.parameters);
  for (std::size_t s = 0; s < data.size(); ++s) {
    FieldData known = fit.data[s];  // the patch is not used in it
    known.value = data[s].value;
    const FieldPosterior posterior = mixed_posterior(model, probable, known);
    for (const std::size_t i : patch) {
      const auto row = static_cast<Eigen::Index>(i);
      const double residual = posterior.left_out_residual[row];
      if (std::isfinite(residual)) {
        sums.count += 1.0;
        sums.squares += residual * residual;
        sums.covered +=
            std::abs(residual) <= kNormal95 * posterior.left_out_sd[row] ? 1.0 : 0.0;
      }
    }
  }
}

}  // namespace

std::vector<std::vector<std::size_t>> patches_of(const FieldModel& model,
                                                 std::size_t count) {
  const std::size_t m = model.point().size();
  std::vector<double> nearest(m, std::numeric_limits<double>::infinity());
  std::vector<std::size_t> of(m, 0);
  std::size_t seed = 0;
  for (std::size_t k = 0; k < std::min(count, m); ++k) {
    const Eigen::Vector3d p = position_m(model.mesh(), model.point()[seed]);
    for (std::size_t i = 0; i < m; ++i) {
      const double d = (position_m(model.mesh(), model.point()[i]) - p).norm();
      if (d < nearest[i]) {
        nearest[i] = d;
        of[i] = k;
      }
    }
    // The next seed is the point farthest from all seeds.
    seed = static_cast<std::size_t>(std::max_element(nearest.begin(), nearest.end()) -
                                    nearest.begin());
  }
  std::vector<std::vector<std::size_t>> patches(std::min(count, m));
  for (std::size_t i = 0; i < m; ++i) {
    patches[of[i]].push_back(i);
  }
  std::erase_if(patches, [](const auto& patch) {
    return patch.empty();  // points at one place
  });
  return patches;
}

PatchScore left_out_patches(const FieldModel& model, std::span<const FieldData> data,
                            const FieldParameters& near) {
  const auto patches =
      patches_of(model, std::min(kPatchesMax, model.point().size() / kPatchPoints));
  PatchScore score{patches.size(), 0, kNaN, kNaN};
  Sums sums;
  for (const auto& patch : patches) {
    if (patches.size() > 1) {
      predict(model, data, patch, near, sums);
    }
  }
  if (sums.count > 0.0) {
    score.points = static_cast<std::size_t>(sums.count) / data.size();
    score.rms = std::sqrt(sums.squares / sums.count);
    score.coverage = sums.covered / sums.count;
  }
  return score;
}

}  // namespace palpate
