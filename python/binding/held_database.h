// A database that Python holds, and the fields that were asked of it.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "formats/database/response_database.h"
#include "runtime/slow/static_field.h"

namespace palpate {

/// Never changed once it is held: arrays look into it. Fields are made under Python's
/// lock.
struct HeldDatabase {
  ResponseDatabase database;
  std::map<const ResponseTable*, std::shared_ptr<const StaticField>> field = {};
};

/// One tool of a held database.
struct HeldTool {
  std::shared_ptr<HeldDatabase> held;
  const ResponseTable* table = nullptr;
};

/// @throws InputError naming the tools that there are.
[[nodiscard]] HeldTool tool_of(const std::shared_ptr<HeldDatabase>& held,
                               const std::string& name);

/// Made at the first call.
[[nodiscard]] std::shared_ptr<const StaticField> field_of(const HeldTool& tool);

}  // namespace palpate
