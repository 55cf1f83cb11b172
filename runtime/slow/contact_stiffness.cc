#include "runtime/slow/contact_stiffness.h"

#include <algorithm>
#include <vector>

#include <Eigen/Cholesky>

#include "formats/response/contact_set.h"
#include "runtime/contacts/coupled_set.h"
#include "runtime/slow/contact_elements.h"
#include "runtime/slow/field_stiffness.h"

namespace palpate {

namespace {

// Of the responses of each contact's own radius. @param force_max_n that they share.
std::vector<RenderedStiffness> stiffness_by_contact(const ResponseDatabase& database,
                                                    const ResponseTable& tool,
                                                    LocalModel model,
                                                    double force_max_n) {
  std::vector<std::size_t> radius = radius_of_contacts(tool.tool.contact);
  if (radius.empty()) {
    radius.push_back(0);
  }
  std::vector<RenderedStiffness> each;
  for (std::size_t i = 0; i < radius.size(); ++i) {
    const auto seen = static_cast<std::size_t>(
        std::find(radius.begin(), radius.end(), radius[i]) - radius.begin());
    each.push_back(
        seen < i
            ? each[seen]
            : model_stiffness(database, table_of_radius(database, tool, radius[i]),
                              model, force_max_n / static_cast<double>(radius.size())));
  }
  return each;
}

}  // namespace

ContactStiffness contact_stiffness(const ResponseDatabase& database,
                                   const ResponseTable& tool, LocalModel model,
                                   double force_max_n) {
  const ResponseTable* const one[] = {&tool};
  const CoupledSet set = coupled_set(one);
  const std::vector<RenderedStiffness> each =
      stiffness_by_contact(database, tool, model, force_max_n);
  const std::int64_t node =
      std::max_element(each.begin(), each.end(), [](const auto& a, const auto& b) {
        return a.normal_n_per_m < b.normal_n_per_m;
      })->node;
  ContactStiffness all;
  const Eigen::Index n = set.count;
  all.lever_m.resize(n, 3);
  Eigen::VectorXd own_n_per_m(n);
  Eigen::MatrixXd compliance(n, n);
  const ContactRow row =
      n > 1 && node >= 0 ? contact_row(tool.compliance, node, 1.0) : ContactRow{};
  const double together = coupling_by_modes(row.mode, row.mode, kMostModes,
                                            static_cast<std::size_t>(set.added_modes));
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto self = static_cast<std::size_t>(i);
    all.friction_n_per_m = std::max(all.friction_n_per_m, each[self].friction_n_per_m);
    all.lever_m.row(i) = set.sphere[self].centre_m.transpose();
    own_n_per_m(i) = each[self].normal_n_per_m;
    for (Eigen::Index j = 0; j < n; ++j) {
      compliance(i, j) =
          i == j ? 1.0 / own_n_per_m(i)
                 : reach_m_per_n(row, set.apart[self][static_cast<std::size_t>(j)]) +
                       together;
    }
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(compliance);
  all.n_per_m = factor.info() == Eigen::Success
                    ? Eigen::MatrixXd(factor.solve(Eigen::MatrixXd::Identity(n, n)))
                    : Eigen::MatrixXd(own_n_per_m.asDiagonal());
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
                                        const ResponseTable& tool, LocalModel model,
                                        double force_max_n) {
  RenderedStiffness sum;
  for (const RenderedStiffness& one :
       stiffness_by_contact(database, tool, model, force_max_n)) {
    sum.node = one.node;
    sum.normal_n_per_m += one.normal_n_per_m;
    sum.friction_n_per_m += one.friction_n_per_m;
  }
  return sum;
}

}  // namespace palpate
