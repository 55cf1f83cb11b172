#include "runtime/slow/contact_stiffness.h"

#include <Eigen/Cholesky>

#include "formats/response/contact_set.h"
#include "runtime/slow/contact_elements.h"

namespace palpate {

ContactStiffness contact_stiffness(const ResponseTable& table, const CoupledSet& set,
                                   const RenderedStiffness& stiffest) {
  const double stiffness_n_per_m = stiffest.normal_n_per_m;
  const std::int64_t node = stiffest.node;
  ContactStiffness all;
  all.friction_n_per_m = stiffest.friction_n_per_m;
  const Eigen::Index n = set.count;
  all.lever_m.resize(n, 3);
  Eigen::MatrixXd compliance = Eigen::MatrixXd::Identity(n, n) / stiffness_n_per_m;
  const ContactRow row =
      n > 1 && node >= 0 ? contact_row(table.compliance, node, 1.0) : ContactRow{};
  const double together = coupling_by_modes(row.mode, row.mode, kMostModes,
                                            static_cast<std::size_t>(set.added_modes));
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto self = static_cast<std::size_t>(i);
    all.lever_m.row(i) = set.sphere[self].centre_m.transpose();
    for (Eigen::Index j = 0; j < n && n > 1; ++j) {
      if (i != j) {
        compliance(i, j) =
            reach_m_per_n(row, set.apart[self][static_cast<std::size_t>(j)]) + together;
      }
    }
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(compliance);
  all.n_per_m =
      factor.info() == Eigen::Success
          ? Eigen::MatrixXd(factor.solve(Eigen::MatrixXd::Identity(n, n)))
          : Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n) * stiffness_n_per_m);
  return all;
}

WrenchMargin coupling_margin(const VirtualCoupling& coupling,
                             const DeviceLimits& device, double hold_s) {
  const double k = coupling.spring_n_per_m;
  WrenchMargin margin = wrench_margin(
      {Eigen::MatrixX3d::Zero(1, 3), Eigen::MatrixXd::Constant(1, 1, k), k},
      device.damping_n_s_per_m, 0.0, hold_s, device.delay_s);
  margin.stiffness_n_m_per_rad = coupling.spring_n_m_per_rad;
  return margin;
}

double every_hand_n_s_per_m(const VirtualCoupling& coupling, double hold_s,
                            double delay_s) {
  return coupling.spring_n_per_m * (0.5 * hold_s + delay_s) + coupling.damper_n_s_per_m;
}

RenderedStiffness stiffness_of_contacts(const ResponseDatabase& database,
                                        const ResponseTable& tool, double force_max_n) {
  const std::vector<std::size_t> radius = radius_of_contacts(tool.tool.contact);
  RenderedStiffness sum;
  for (const std::size_t r : radius) {
    const RenderedStiffness one =
        rendered_stiffness(table_of_radius(database, tool, r),
                           force_max_n / static_cast<double>(radius.size()));
    sum.node = one.node;
    sum.normal_n_per_m += one.normal_n_per_m;
    sum.friction_n_per_m += one.friction_n_per_m;
  }
  return sum;
}

}  // namespace palpate
