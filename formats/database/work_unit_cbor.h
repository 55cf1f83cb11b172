// How units and plans stand in CBOR; only for response_shard.cc and its tests.
#pragma once

#include <nlohmann/json.hpp>

#include "formats/database/work_unit.h"

namespace palpate {

void to_json(nlohmann::json& json, const WorkUnitOutcome& unit);
void from_json(const nlohmann::json& json, WorkUnitOutcome& unit);
void to_json(nlohmann::json& json, const JobDescription& plan);
void from_json(const nlohmann::json& json, JobDescription& plan);

}  // namespace palpate
