#include "text/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <clocale>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "mr_hand_interaction/synthetic/random.h"
#include "replay/replay_files.h"
#include "text/files.h"

namespace mrhi {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Numbers of every size and both signs, the borders of what a double holds among them.
std::vector<double> all_sorts_of_numbers() {
  std::vector<double> numbers{0.0,
                              -0.0,
                              0.1,
                              1.0 / 3.0,
                              100.0,
                              123456.0,
                              1234567.0,
                              std::numeric_limits<double>::max(),
                              std::numeric_limits<double>::lowest(),
                              std::numeric_limits<double>::min(),
                              std::numeric_limits<double>::epsilon(),
                              std::nextafter(1.0, 2.0)};
  Random random(3);
  for (int i = 0; i < 500; ++i)
    numbers.push_back((random.uniform() - 0.5) * std::pow(10.0, 40.0 * random.uniform() - 20.0));
  return numbers;
}

TEST(Text, an_exact_number_is_read_back_as_the_same_bits) {
  for (const double number : all_sorts_of_numbers()) {
    const std::optional<double> back = text::to_number(text::exact(number));
    ASSERT_TRUE(back) << number;
    EXPECT_EQ(*back, number) << text::exact(number);
    EXPECT_EQ(std::signbit(*back), std::signbit(number));
  }
}

TEST(Text, an_exact_number_is_as_short_as_it_can_be) {
  EXPECT_EQ(text::exact(0.1), "0.1");
  EXPECT_EQ(text::exact(-2.5), "-2.5");
  EXPECT_EQ(text::exact(0.1234567), "0.1234567");
  EXPECT_EQ(text::exact(1.0 / 3.0), "0.3333333333333333");
  EXPECT_EQ(text::exact(0.1 + 0.2), "0.30000000000000004");
}

TEST(Text, a_number_for_people_has_six_digits) {
  EXPECT_EQ(text::number(1.0 / 3.0), "0.333333");
  EXPECT_EQ(text::number(-1500.0), "-1500");
  EXPECT_EQ(text::number(1234567.0), "1.23457e+06");
  EXPECT_EQ(text::vector({0.5, -1.0, 2e-7}), "[0.5, -1, 2e-07]");
}

TEST(Text, a_number_is_the_whole_text_or_none) {
  EXPECT_EQ(text::to_number("0.25"), 0.25);
  EXPECT_EQ(text::to_number("-1e-3"), -0.001);
  EXPECT_EQ(text::to_number("inf"), kInfinity);
  for (const char* no_number : {"", "x", "1 ", "1,5", "1.5m", "0.1 0.2", "1e", "--1"})
    EXPECT_FALSE(text::to_number(no_number)) << no_number;
  EXPECT_FALSE(text::to_number(std::string("1\0 2", 4)));
}

/// Puts the program's own locale back.
struct Locale {
  explicit Locale(const char* name) : set(std::setlocale(LC_ALL, name) != nullptr) {}
  ~Locale() { std::setlocale(LC_ALL, "C"); }
  const bool set;
};

TEST(Text, numbers_have_a_point_in_every_locale) {
  for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "C.UTF-8"}) {
    const Locale locale(name);
    if (!locale.set) continue;  // not on this machine; C.UTF-8 always is
    EXPECT_EQ(text::to_number("1.5"), 1.5);
    EXPECT_FALSE(text::to_number("1,5"));
    EXPECT_EQ(text::number(1.5), "1.5");
    EXPECT_EQ(text::number(1'000'000.0), "1e+06");
    EXPECT_EQ(text::exact(12345.25), "12345.25");
  }
}

TEST(Text, one_line_has_single_spaces_and_nothing_that_a_terminal_obeys) {
  EXPECT_EQ(text::one_line("a\nb\r\n c\t\td"), "a b c d");
  EXPECT_EQ(text::one_line("  a  "), "a");
  EXPECT_EQ(text::one_line("\x1b[31mred\x07\x7f"), "?[31mred??");
  EXPECT_EQ(text::one_line("W\xC3\xBCrfel"), "W\xC3\xBCrfel");
  EXPECT_EQ(text::one_line("\n \t"), "");
  EXPECT_EQ(text::one_line("\xC2\x9B"
                           "31m\xC2\xA0\xC2\x80"),
            "?31m\xC2\xA0?")
      << "C1 controls";
  EXPECT_EQ(text::one_line("a\xFF\x9B\xE2\x82 b\xC3"), "a???? b?") << "bytes that are not UTF-8";
  const std::string line = text::one_line("a \n\x01 b ");
  EXPECT_EQ(text::one_line(line), line);
}

TEST(Text, one_line_is_cut_beyond_its_length_alone) {
  EXPECT_EQ(text::one_line("abcdef", 6), "abcdef");
  EXPECT_EQ(text::one_line("abcdefg", 6), "abcdef...");
  EXPECT_EQ(text::one_line("abcde\xC3\xBC", 6), "abcde...") << "between characters";
  EXPECT_EQ(text::one_line(std::string(300, 'x')), std::string(300, 'x'));
  EXPECT_EQ(text::one_line(std::string(301, 'x')), std::string(300, 'x') + "...");
}

TEST(Text, what_was_split_at_commas_and_is_joined_again_is_the_same) {
  for (const std::string line : {"", ",", "a", "a,b", ",a,,b,"}) {
    const std::vector<std::string> fields = text::split(line);
    EXPECT_EQ(fields.size(), 1 + std::size_t(std::count(line.begin(), line.end(), ',')));
    std::string again = fields.front();
    for (std::size_t i = 1; i < fields.size(); ++i) again += "," + fields[i];
    EXPECT_EQ(again, line);
  }
  EXPECT_EQ(text::joined({"a", "b", "c"}), "a, b, c");
  EXPECT_EQ(text::joined({}), "");
  EXPECT_EQ(text::with_spaces("time_of_a_trial"), "time of a trial");
}

TEST(Text, a_name_is_of_letters_digits_bars_and_dashes) {
  for (const std::string& name :
       {std::string("P07"), std::string("_x"), std::string("a-b_C"), std::string("7"), std::string(64, 'z')})
    EXPECT_TRUE(is_name(name)) << name;
  for (const std::string& name :
       {std::string(), std::string("-x"), std::string("a b"), std::string("a/b"), std::string("a.b"),
        std::string("=x"), std::string("\xC3\xBC"), std::string(65, 'z'), std::string("a\0b", 3)})
    EXPECT_FALSE(is_name(name)) << name;
}

struct Entry {
  int place;
  const char* name;
};

TEST(Registry, has_its_entries_in_the_order_of_their_places_and_names) {
  const Entry c{1, "c"}, a{1, "a"}, first{0, "z"};
  const auto names = [](const std::vector<const Entry*>& entries) {
    std::string all;
    for (const Entry* entry : entries) all += entry->name;
    return all;
  };
  EXPECT_EQ(names(in_their_places<Entry>({&c, &a, &first})), "zac");
  EXPECT_EQ(names(in_their_places<Entry>({&first, &c, &a})), "zac");
}

TEST(Registry, gives_an_entry_by_its_whole_name_and_else_tells_which_there_are) {
  const Entry one{0, "one"}, other{1, "other"};
  const std::vector<const Entry*> entries{&one, &other};
  EXPECT_EQ(&entry_named(entries, "other", "filter"), &other);
  for (const char* name : {"", "on", "One"}) {
    try {
      entry_named(entries, name, "filter");
      FAIL() << name;
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(std::string(error.what()),
                "filter '" + std::string(name) + "' is not known; allowed: one, other");
    }
  }
}

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
  const test::Folder folder;
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
