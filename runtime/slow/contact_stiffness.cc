#include "runtime/slow/contact_stiffness.h"

#include <algorithm>
#include <vector>

#include <Eigen/Cholesky>

#include "formats/response/contact_set.h"
#include "runtime/contacts/coupled_set.h"
#include "runtime/slow/contact_elements.h"
#include "runtime/slow/field_stiffness.h"

namespace palpate {

std::vector<StiffestNode> stiffest_by_contact(const ToolShape& tool, double force_max_n,
                                              const StiffestOfTable& stiffest) {
  std::vector<std::size_t> radius = radius_of_contacts(tool.contact);
  if (radius.empty()) {
    radius.push_back(0);
  }
  const double each_n = force_max_n / static_cast<double>(radius.size());
  std::vector<StiffestNode> contact;
  for (std::size_t i = 0; i < radius.size(); ++i) {
    const auto seen = static_cast<std::size_t>(
        std::find(radius.begin(), radius.end(), radius[i]) - radius.begin());
    contact.push_back(seen < i ? contact[seen]
                               : stiffest(table_name(tool.name, radius[i]), each_n));
  }
  return contact;
}

std::vector<StiffestNode> stiffest_by_contact(const ResponseDatabase& database,
                                              const ResponseTable& tool,
                                              LocalModel model, double force_max_n) {
  return stiffest_by_contact(
      tool.tool, force_max_n, [&](const std::string& table, double each_n) {
        StiffestNode most{
            model_stiffness(database, find_tool(database, table), model, each_n), {}};
        if (most.stiffness.node >= 0 && !tool.compliance.empty()) {
          most.row = contact_row(tool.compliance, most.stiffness.node, 1.0);
        }
        return most;
      });
}

ContactStiffness contact_stiffness(const PressingTool& tool,
                                   std::span<const StiffestNode> contact) {
  const CoupledSet set = coupled_set(std::span(&tool, 1));
  const ContactRow& row =
      std::max_element(contact.begin(), contact.end(),
                       [](const auto& a, const auto& b) {
                         return a.stiffness.normal_n_per_m < b.stiffness.normal_n_per_m;
                       })
          ->row;
  ContactStiffness all;
  const Eigen::Index n = set.count;
  all.lever_m.resize(n, 3);
  Eigen::VectorXd own_n_per_m(n);
  Eigen::MatrixXd compliance(n, n);
  // sum_m s_m b_m^2: modes couple contacts at every distance.
  const double together = coupling_by_modes(row.mode, row.mode, kMostModes,
                                            static_cast<std::size_t>(set.added_modes));
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto self = static_cast<std::size_t>(i);
    const RenderedStiffness& own = contact[self].stiffness;
    all.friction_n_per_m = std::max(all.friction_n_per_m, own.friction_n_per_m);
    all.lever_m.row(i) = set.sphere[self].centre_m.transpose();
    own_n_per_m(i) = own.normal_n_per_m;
    for (Eigen::Index j = 0; j < n; ++j) {
      compliance(i, j) =
          i == j ? 1.0 / own_n_per_m(i)
                 : reach_m_per_n(row, set.apart[self][static_cast<std::size_t>(j)]) +
                       together;
    }
  }
  // K = (diag(1 / k_i) + C)^-1 [N/m]: forces on the contacts for their displacements.
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

RenderedStiffness stiffness_of_contacts(std::span<const StiffestNode> contact) {
  RenderedStiffness sum;
  for (const StiffestNode& one : contact) {
    sum.node = one.stiffness.node;
    sum.normal_n_per_m += one.stiffness.normal_n_per_m;
    sum.friction_n_per_m += one.stiffness.friction_n_per_m;
  }
  return sum;
}

}  // namespace palpate
