#include "precompute/fem/element_batches.h"

#include <algorithm>
#include <limits>

namespace palpate {
namespace {

// Most elements turn little and pass at the price of a factor: their negative
// eigenvalues, those of rotations under pressure, are small, and the others make up for
// them.
constexpr double kNegligible = 0.01;  // [-] of the mean diagonal

using Matrix3 = Eigen::Map<const Eigen::Matrix3d>;

double energy_at(const void* law, const double* F) {
  return distortion_energy(*static_cast<const Material*>(law), Matrix3(F));
}

double response_at(const void* law, const double* F, double* stress, double* tangent) {
  const LocalResponse local =
      distortion_response(*static_cast<const Material*>(law), Matrix3(F));
  std::copy_n(local.stress.data(), 9, stress);
  std::copy_n(local.tangent.data(), 81, tangent);
  return local.energy_density;
}

BatchVolume volume_of(VolumeMeasure measure) {
  switch (measure) {
    case VolumeMeasure::kSmallTrace:
      return BatchVolume::kSmallTrace;
    case VolumeMeasure::kGreenTrace:
      return BatchVolume::kGreenTrace;
    case VolumeMeasure::kJacobian:
      return BatchVolume::kJacobian;
    case VolumeMeasure::kNone:
      break;
  }
  return BatchVolume::kNone;
}

void set_geometry(const ElementGeometry& from, std::size_t lane, ElementBatch& to) {
  to.volume_m3[lane] = from.volume_m3;
  for (std::size_t q = 0; q < kElementPoints; ++q) {
    for (std::size_t a = 0; a < kElementNodes; ++a) {
      for (std::size_t i = 0; i < 3; ++i) {
        to.gradient[q][a][i][lane] = from.gradient[q](static_cast<Eigen::Index>(a),
                                                      static_cast<Eigen::Index>(i));
      }
    }
  }
}

ElementGeometry geometry_of(const ElementBatch& batch, std::size_t lane) {
  ElementGeometry geometry{.volume_m3 = batch.volume_m3[lane], .gradient = {}};
  for (std::size_t q = 0; q < kElementPoints; ++q) {
    for (std::size_t a = 0; a < kElementNodes; ++a) {
      for (std::size_t i = 0; i < 3; ++i) {
        geometry.gradient[q](static_cast<Eigen::Index>(a),
                             static_cast<Eigen::Index>(i)) =
            batch.gradient[q][a][i][lane];
      }
    }
  }
  return geometry;
}

}  // namespace

BatchLaw batch_law(const Material& material) {
  BatchLaw law;
  law.volume = volume_of(volume_measure(material));
  law.volume_modulus_pa = volume_modulus_pa(material);
  law.law = &material;
  law.energy = energy_at;
  law.response = response_at;
  const auto by_strain = [&](BatchLaw::Kind kind, double mu_pa, double lambda_pa) {
    law.kind = kind;
    law.mu_pa = mu_pa;
    law.lambda_pa = std::min(lambda_pa, 0.0);  // the volume term has the positive part
  };
  if (const auto* neo = std::get_if<NeoHookean>(&material)) {
    law.kind = BatchLaw::Kind::kInvariants;
    law.c10_pa = 0.5 * neo->shear_modulus_pa;
  } else if (const auto* mooney = std::get_if<MooneyRivlin>(&material)) {
    law.kind = BatchLaw::Kind::kInvariants;
    law.c10_pa = mooney->c10_pa;
    law.c01_pa = mooney->c01_pa;
  } else if (const auto* green = std::get_if<StVenantKirchhoff>(&material)) {
    by_strain(BatchLaw::Kind::kGreenStrain, green->shear_modulus_pa,
              green->lame_lambda_pa);
  } else if (const auto* small = std::get_if<Linear>(&material)) {
    by_strain(BatchLaw::Kind::kSmallStrain, small->shear_modulus_pa,
              small->lame_lambda_pa);
  }
  return law;
}

ElementBatches::ElementBatches(NodeGroups node,
                               std::span<const ElementGeometry> geometry,
                               std::span<const std::int32_t> region,
                               std::span<const Material> materials)
    : node_(std::move(node)), materials_(materials) {
  std::vector<std::vector<std::size_t>> open(materials.size());
  for (std::size_t law = 0; law < materials.size(); ++law) {
    law_.push_back(batch_law(materials[law]));
  }
  for (std::size_t e = 0; e < geometry.size(); ++e) {
    const auto law = static_cast<std::size_t>(region[e]);
    if (open[law].empty()) {
      open[law].push_back(batch_.size());
      batch_.emplace_back().law = law;
    }
    // An element fills its place and all places after it. A batch that stays open
    // therefore holds its last element several times, and `count` says how many are
    // real.
    Batch& batch = batch_[open[law].back()];
    for (std::size_t lane = batch.count; lane < kBatch; ++lane) {
      batch.element[lane] = static_cast<Eigen::Index>(e);
      set_geometry(geometry[e], lane, batch.geometry);
    }
    if (++batch.count == kBatch) {
      open[law].clear();
    }
  }
}

void ElementBatches::gather(const Batch& batch, const Eigen::VectorXd& u_m,
                            BatchVector& u) const {
  for (std::size_t lane = 0; lane < kBatch; ++lane) {
    const auto nodes = node_.row(batch.element[lane]);
    for (std::size_t a = 0; a < kElementNodes; ++a) {
      const double* from =
          u_m.data() + 3 * std::ptrdiff_t{nodes[static_cast<Eigen::Index>(a)]};
      for (std::size_t i = 0; i < 3; ++i) {
        u[(3 * a + i) * kBatch + lane] = from[i];
      }
    }
  }
}

ElementBatches::Energy ElementBatches::energy(const Eigen::VectorXd& u_m) const {
  const ElementKernels& kernels = element_kernels();
  Energy all;
  BatchVector u;
  for (const Batch& batch : batch_) {
    std::array<double, kBatch> energy_j;
    std::array<double, kBatch> jacobian;
    gather(batch, u_m, u);
    kernels.energy(batch.geometry, law_[batch.law], u.data(), energy_j.data(),
                   jacobian.data());
    for (std::size_t lane = 0; lane < batch.count; ++lane) {
      all.energy_j += energy_j[lane];
      all.smallest_jacobian = std::min(all.smallest_jacobian, jacobian[lane]);
    }
  }
  if (!(all.energy_j < std::numeric_limits<double>::infinity())) {
    all.energy_j = std::numeric_limits<double>::infinity();
  }
  return all;
}

// Those that are not definite are done again one by one, with their laws' tangents
// clipped.
void ElementBatches::make_convex(const Batch& batch, const BatchVector& u,
                                 BatchResponse& response) const {
  std::array<char, kBatch> definite;
  element_kernels().is_definite(response, kNegligible, definite.data());
  for (std::size_t lane = 0; lane < batch.count; ++lane) {
    if (definite[lane] != 0) {
      continue;
    }
    ElementVector u_m;
    for (std::size_t i = 0; i < kElementUnknowns; ++i) {
      u_m[static_cast<Eigen::Index>(i)] = u[i * kBatch + lane];
    }
    const ElementMatrix K = element_response(geometry_of(batch.geometry, lane),
                                             materials_[batch.law], u_m, true)
                                .stiffness;
    for (Eigen::Index a = 0, block = 0; a < 10; ++a) {
      for (Eigen::Index b = 0; b <= a; ++b, ++block) {
        for (Eigen::Index k = 0; k < 9; ++k) {
          response.stiffness[block][k][lane] = K(3 * a + k % 3, 3 * b + k / 3);
        }
      }
    }
  }
}

void ElementBatches::linearise(
    const Eigen::VectorXd& u_m, bool convex,
    const std::function<void(const Batch&, const BatchResponse&)>& take) const {
  BatchVector u;
  BatchResponse response;
  for (const Batch& batch : batch_) {
    gather(batch, u_m, u);
    element_kernels().linearise(batch.geometry, law_[batch.law], u.data(), response);
    if (convex) {
      make_convex(batch, u, response);
    }
    take(batch, response);
  }
}

void ElementBatches::add_forces(const Batch& batch, const BatchResponse& response,
                                Eigen::VectorXd& force_n) const {
  for (std::size_t lane = 0; lane < batch.count; ++lane) {
    const auto nodes = node_.row(batch.element[lane]);
    for (std::size_t a = 0; a < kElementNodes; ++a) {
      double* to =
          force_n.data() + 3 * std::ptrdiff_t{nodes[static_cast<Eigen::Index>(a)]};
      for (std::size_t i = 0; i < 3; ++i) {
        to[i] += response.force_n[3 * a + i][lane];
      }
    }
  }
}

}  // namespace palpate
