#include "formats/forms/open_stored.h"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/quiet_exit.h"
#include "tests/support/said.h"
#include "tests/support/test_data.h"

namespace palpate {
namespace {

// A small file of a form: a number, a text, an array with flags.
std::string small_file(StoredForm form) {
  StoredWriter writer = make_writer(form);
  writer.attribute("/", "count", std::int64_t{7});
  writer.attribute("/", "rate", 0.25);
  writer.attribute("/", "empty", std::string());
  writer.group("/group");
  writer.text("/group/text", "two\nlines");
  writer.dataset("/group/values", "m", std::vector<double>{1.0, 2.0, 3.0});
  writer.flags("/group/values", {0, 1}, "none some", true);
  writer.remark("/", kDigestName, writer.digest());
  const std::span<const std::byte> image = writer.image();
  return {reinterpret_cast<const char*>(image.data()), image.size()};
}

StoredReader reader_of(const std::string& bytes) {
  return StoredReader(open_stored(StoredSource(std::as_bytes(std::span(bytes)))));
}

class OpenStored : public testing::TestWithParam<StoredForm> {};

INSTANTIATE_TEST_SUITE_P(Forms, OpenStored,
                         testing::Values(StoredForm::kHdf5, StoredForm::kFlat),
                         [](const auto& form) {
                           return form.param == StoredForm::kFlat ? "flat" : "hdf5";
                         });

TEST_P(OpenStored, ReadsWhatWasWrittenAndDigestsTheSame) {
  const std::string bytes = small_file(GetParam());
  StoredReader reader = reader_of(bytes);
  std::int64_t count = 0;
  double rate = 0.0;
  std::string empty = "x";
  std::string text;
  std::vector<double> values;
  reader.attribute("/", "count", count);
  reader.attribute("/", "rate", rate);
  reader.attribute("/", "empty", empty);
  reader.group("/group");
  reader.text("/group/text", text);
  reader.dataset("/group/values", "m", values);
  EXPECT_EQ(count, 7);
  EXPECT_EQ(rate, 0.25);
  EXPECT_EQ(empty, "");
  EXPECT_EQ(text, "two\nlines");
  EXPECT_EQ(values, (std::vector<double>{1.0, 2.0, 3.0}));
  EXPECT_EQ(reader.remark("/group/values", "flag_meanings"), "none some");
  EXPECT_EQ(reader.digest(), reader.remark("/", kDigestName));
  EXPECT_EQ(reader.file().bytes(), bytes.size());
}

TEST_P(OpenStored, SaysTheSameOfWhatIsNotThere) {
  const std::string bytes = small_file(GetParam());
  StoredReader reader = reader_of(bytes);
  const auto said_of = [](const auto& work) {
    return refusal(work).substr(std::string("bytes in memory: ").size());
  };
  std::string text;
  std::int64_t count = 0;
  std::vector<double> values;
  std::vector<float> floats;
  RowMajor<double> rows;
  EXPECT_EQ(said_of([&] {
              reader.group("/none");
            }),
            "group /none is missing");
  EXPECT_EQ(said_of([&] {
              reader.text("/none", text);
            }),
            "dataset /none is missing");
  EXPECT_EQ(said_of([&] {
              reader.attribute("/", "none", count);
            }),
            "attribute /@none is missing");
  EXPECT_EQ(said_of([&] {
              reader.attribute("/", "rate", count);
            }),
            "attribute /@rate has the wrong type, must be one int64");
  EXPECT_EQ(said_of([&] {
              reader.attribute("/", "count", text);
            }),
            "attribute /@count is not a fixed-length text");
  EXPECT_EQ(said_of([&] {
              reader.text("/group/values", text);
            }),
            "dataset /group/values is not one fixed-length text");
  EXPECT_EQ(said_of([&] {
              reader.dataset("/group/values", "m", floats);
            }),
            "dataset /group/values has the wrong element type, must be float32");
  EXPECT_EQ(said_of([&] {
              reader.dataset("/group/values", "m", rows);
            }),
            "dataset /group/values has the shape (3), must be (rows x any)");
  EXPECT_EQ(said_of([&] {
              reader.dataset("/group/values", "s", values);
            }),
            "dataset /group/values has the units \"m\", must be \"s\"");
  EXPECT_EQ(said_of([&] {
              double to[3] = {};
              reader.rows("/group/values", "m", StoredType::kFloat64, 1, 3, 0, to);
            }),
            "dataset /group/values has 3 rows, the index asks for 3 from 1");
  EXPECT_NE(said_of([&] {
              reader.group("/group/values");
            }).find("/group/values cannot be opened as a group: "),
            std::string::npos);
  EXPECT_NE(said_of([&] {
              reader.dataset("/group", "m", values);
            }).find("dataset /group cannot be opened: "),
            std::string::npos);
}

TEST_P(OpenStored, RowsAreThoseOfTheWhole) {
  StoredWriter writer = make_writer(GetParam());
  RowMajor<float> written(4, 3);
  for (Eigen::Index i = 0; i < written.size(); ++i) {
    written.data()[i] = static_cast<float>(i);
  }
  writer.dataset("/rows", "1", written);
  const std::span<const std::byte> image = writer.image();
  const StoredReader reader(open_stored(StoredSource(image)));
  RowMajor<float> some(2, 3);
  reader.rows("/rows", "1", StoredType::kFloat32, 1, 2, 3, some.data());
  EXPECT_EQ(some, written.middleRows(1, 2));
  reader.rows("/rows", "1", StoredType::kFloat32, 4, 0, 3, some.data());
}

TEST(OpenStoredFile, ItsNameAsksForItsForm) {
  EXPECT_EQ(form_of("a.palpate"), StoredForm::kFlat);
  EXPECT_EQ(form_of("folder.palpate/a.h5"), StoredForm::kHdf5);
  EXPECT_EQ(form_of("a"), StoredForm::kHdf5);
}

TEST(OpenStoredFile, ItsBytesTellNotItsName) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder / "a.h5";
  std::ofstream(file, std::ios::binary) << small_file(StoredForm::kFlat);
  EXPECT_STREQ(open_stored(file)->form(), "a flat file");
  std::ofstream(file, std::ios::binary) << small_file(StoredForm::kHdf5);
  EXPECT_STREQ(open_stored(file)->form(), "an HDF5 file");
  std::ofstream(file, std::ios::binary) << "\x89PAL";
  EXPECT_EQ(refusal([&] {
              (void)open_stored(file);
            }),
            file.string() +
                ": is not an HDF5 file (4 bytes), nor a flat one, must be a response "
                "database");
  EXPECT_NE(refusal([&] {
              (void)open_stored(folder / "none.h5");
            }).find("no such file"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate
