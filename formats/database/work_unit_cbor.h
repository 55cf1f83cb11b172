// How units and plans stand in CBOR; only for response_shard.cc and its tests.
#pragma once

#include <nlohmann/json.hpp>

#include "formats/database/work_unit.h"

namespace palpate {

void to_json(nlohmann::json& json, const UnitOutcome& unit);
void from_json(const nlohmann::json& json, UnitOutcome& unit);
void to_json(nlohmann::json& json, const UnitPlan& plan);
void from_json(const nlohmann::json& json, UnitPlan& plan);

}  // namespace palpate
