// csharp_bodies FOLDER: what the tests of the C# files press. f = 2e4 d^2 everywhere.
//   plate.h5   one contact         pads.h5    tools "pads" (three contacts) and "ball",
//   dents.h5   yields                         with displacement fields
//   needle.h5  is punctured       relaxing.h5  relaxes
#include <filesystem>

#include "formats/database/table_memory.h"
#include "tests/support/padded_plate.h"
#include "tests/support/punctured_plate.h"

namespace {

using palpate::ResponseDatabase;

// All sinks along -z by a millimetre where a node is pressed by 4 mm.
void store_fields(ResponseDatabase& database) {
  const Eigen::Index n = database.body.position_m.rows();
  for (palpate::ResponseTable& table : database.tools) {
    palpate::DisplacementField& field = table.displacement;
    field.basis = palpate::RowMajorMatrixF::Zero(3 * n, 1);
    for (Eigen::Index i = 0; i < n; ++i) {
      field.basis(3 * i + 2, 0) = -1.0F;
      field.node.push_back(static_cast<std::int32_t>(i));
      field.depth_m.push_back(0.004);
      field.error_relative.push_back(0.0);
    }
    field.coefficient = palpate::RowMajorMatrixF::Constant(n, 1, 1e-3F);
  }
}

ResponseDatabase soft_plate() {
  return palpate::sample_database(
      palpate::plate(0.1, 10), palpate::ball(0.005, 0.3, 5e-4),
      [](Eigen::Index /*node*/, double d) {
        return 2e4 * d * d;
      },
      0.01, 41);
}

// A plate whose dents stay in part.
ResponseDatabase dented_plate() {
  ResponseDatabase database = soft_plate();
  palpate::Viscoelasticity yields;
  yields.yielding.yield_depth_m = {0.001};
  yields.yielding.share = {0.4};
  palpate::give_memory(database.body, database.normal, yields, 1, database.tools[0]);
  return database;
}

// A plate whose force relaxes by a half.
ResponseDatabase relaxing_plate() {
  ResponseDatabase database = soft_plate();
  palpate::Viscoelasticity relaxes;
  relaxes.instantaneous = true;
  relaxes.tau_s = {0.05, 0.6};
  relaxes.g.resize(1, 2);
  relaxes.g << 0.3F, 0.2F;
  palpate::give_memory(database.body, database.normal, relaxes, 2, database.tools[0]);
  return database;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  ResponseDatabase pads = palpate::padded_plate(3);
  store_fields(pads);
  palpate::write_database(folder / "pads.h5", pads);
  palpate::write_database(folder / "plate.h5", soft_plate());
  palpate::write_database(folder / "dents.h5", dented_plate());
  palpate::write_database(folder / "relaxing.h5", relaxing_plate());
  palpate::write_database(folder / "needle.h5", palpate::punctured_plate());
  return 0;
}
