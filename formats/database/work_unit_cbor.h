// How units and plans stand in CBOR; only for shards and the service's messages.
#pragma once

#include <nlohmann/json.hpp>

#include "formats/database/work_unit.h"

namespace palpate {

[[nodiscard]] nlohmann::json json_list(const Eigen::Vector3d& v);

void to_json(nlohmann::json& json, const WorkUnitOutcome& unit);
void from_json(const nlohmann::json& json, WorkUnitOutcome& unit);
void to_json(nlohmann::json& json, const JobDescription& plan);
void from_json(const nlohmann::json& json, JobDescription& plan);

}  // namespace palpate
