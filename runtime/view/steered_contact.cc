#include "runtime/view/steered_contact.h"

#include <utility>

#include "formats/base/error.h"
#include "runtime/view/view_contact.h"

namespace palpate {

SteeredContact::SteeredContact(const ResponseDatabase& database,
                               const ResponseTable& table, const FastConfig& config,
                               KeptSurface surface, ElementSender* growing)
    : database_(database),
      table_(table),
      config_(config),
      surface_(std::move(surface)),
      stream_(database, table),
      adjusted_(growing != nullptr ? *growing : stream_),
      dents_(table) {
  begin();
}

void SteeredContact::begin() {
  body_ = std::make_unique<OneContact>(config_, adjusted_);
  body_->begin_with(surface_);
  needle_.reset();
}

void SteeredContact::set(const ViewRequest& request) {
  if (request.coupled) {
    throw InputError("one contact couples with no other");
  }
  if (request.model && body_->needle().punctures && !is_field(*request.model)) {
    throw InputError("a needle needs the model potential or facets");
  }
  if (request.model) {
    config_.model = *request.model;
    body_->use(*request.model);
  }
  if (request.stiffness_scale) {
    adjusted_.set_stiffness_scale(*request.stiffness_scale);
  }
  if (request.friction || request.database_friction) {
    adjusted_.set_friction(request.friction);
  }
}

void SteeredContact::show(const std::vector<SteeredHand>& /*hand*/, ViewFrame& frame) {
  const Eigen::Map<const Eigen::Vector3d> tool_m(frame.now.position_m.data());
  if (const NeedleSeen needle = body_->needle(); needle.punctures) {
    needle_ = view_needle(needle.state, table_.tool, needle_);
  }
  frame.needle = needle_;
  frame.contact = tool_contact(database_, table_.tool, stream_.search(), tool_m,
                               frame.now.triangle, needle_);
  frame.dents = dents_.at(body_->dents(), adjusted_.stiffness_scale());
}

void SteeredContact::tell(ViewSettings& settings) const {
  settings.model = config_.model;
  settings.stiffness_scale = adjusted_.stiffness_scale();
  settings.friction = adjusted_.friction();
}

}  // namespace palpate
