#include "runtime/served/scene_watch.h"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/test_data.h"

namespace palpate {
namespace {

TEST(SceneWatch, SeesAChangeThatIsSaved) {
  const ScratchFolder folder;
  const auto file = folder / "scene.toml";
  std::ofstream(file) << "depth = 1\n";
  EXPECT_FALSE(SceneWatch(file).changed_from("depth = 1\n"));
  EXPECT_TRUE(SceneWatch(file).changed_from("depth = 2\n"));
  EXPECT_FALSE(SceneWatch(folder / "gone").changed_from("depth = 2\n"));
}

}  // namespace
}  // namespace palpate
