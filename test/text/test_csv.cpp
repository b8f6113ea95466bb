#include "text/files.h"

#include <gtest/gtest.h>

#include <sstream>
#include <stdexcept>

#include "replay/replay_files.h"
#include "text/text.h"

namespace mrhi {
namespace {

TEST(Csv, a_row_has_a_cell_for_each_value_and_empty_ones_for_what_is_not_there) {
  std::ostringstream out;
  CsvRows row(out);
  row << 1 << -0.5 << true << "cube" << Vector3(1, 2, 3) << std::optional<double>()
      << std::optional<double>(0.25) << std::optional<Vector3>();
  row.skip(2).end_row();
  row << std::string() << 7;
  row.end_row();
  EXPECT_EQ(out.str(), "1,-0.5,1,cube,1,2,3,,0.25,,,,,\n,7\n");
}

TEST(Csv, a_text_that_would_end_its_cell_or_row_is_in_quotes) {
  EXPECT_EQ(csv_cell("as recorded"), "as recorded");
  EXPECT_EQ(csv_cell("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_cell("a \"b\""), "\"a \"\"b\"\"\"");
  EXPECT_EQ(csv_cell("a\nb"), "\"a\nb\"");
}

TEST(Csv, a_text_is_no_formula_of_a_spreadsheet_and_a_number_stays_one) {
  for (const char* text : {"=1+1", "+A1", "-A1", "@SUM(A1)", "\t=1"})
    EXPECT_EQ(csv_cell(text), "'" + std::string(text));
  EXPECT_EQ(csv_cell("=A1,B1"), "\"'=A1,B1\"");
  for (const char* number : {"-0.5", "-1e-3"}) EXPECT_EQ(csv_cell(number), number);
  EXPECT_EQ(csv_cell("a=b"), "a=b");
}

TEST(Csv, a_file_has_numbers_of_twelve_digits) {
  const test::TemporaryFolder folder;
  CsvFile file(folder / "a.csv", "a,b");
  file << 1.0 / 3.0 << 100'000'000.25;
  file.end_row();
  file.flush();
  EXPECT_EQ(file_text(folder / "a.csv", 100), "a,b\n0.333333333333,100000000.25\n");
}

TEST(Csv, a_file_that_cannot_be_made_and_a_disk_that_is_full_are_told_by_the_files_name) {
  EXPECT_THROW(CsvFile("/nowhere/at/all.csv", "a"), std::runtime_error);
  try {
    CsvFile file("/dev/full", "a,b");
    for (int i = 0; i < 10'000; ++i) {
      file << i << 0.1;
      file.end_row();
    }
    file.flush();
    FAIL() << "no exception";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()), "cannot write /dev/full: No space left on device");
  }
}

TEST(Csv, a_line_is_split_at_its_commas_alone) {
  EXPECT_EQ(text::split("a, b,,c"), (std::vector<std::string>{"a", " b", "", "c"}));
  EXPECT_EQ(text::split(""), std::vector<std::string>{""});
  EXPECT_EQ(text::split(","), (std::vector<std::string>{"", ""}));
}

}  // namespace
}  // namespace mrhi
